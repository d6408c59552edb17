#include "core/harmonics/harmonic_basis.h"

#include <Spectra/SymEigsSolver.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <string>

#include "core/laplacian/constant_modes.h"
#include "core/laplacian/frequency.h"
#include "core/mesh/mesh.h"
#include "core/support/errors.h"
#include "core/support/thread_team.h"

namespace spectral {

namespace {

/// Up to this many vertices the dense solver is about as quick as slices, whose Krylov spaces must
/// be small beside all.
constexpr Index kDenseVertices = 300;

constexpr int kMaxRestarts = 300;

/// Matrix-vector product with D^-1/2 W D^-1/2.
class ScaledStiffness {
  public:
    using Scalar = double;

    explicit ScaledStiffness(const Laplacian& laplacian)
        : W_(laplacian.W), invSqrtD_(laplacian.D.cwiseSqrt().cwiseInverse()) {}
    Index rows() const { return W_.rows(); }
    Index cols() const { return W_.cols(); }
    void perform_op(const double* in, double* out) const {
        const Eigen::VectorXd u =
            invSqrtD_.cwiseProduct(Eigen::Map<const Eigen::VectorXd>(in, rows()));
        Eigen::Map<Eigen::VectorXd>(out, rows()) = invSqrtD_.cwiseProduct(W_ * u);
    }

  private:
    const SparseMatrix& W_;
    Eigen::VectorXd invSqrtD_;
};

/// The manifold harmonic transform Phi^T D X.
Eigen::MatrixXd transform(const Eigen::MatrixXd& Phi, const Eigen::VectorXd& D,
                          const Eigen::MatrixXd& X) {
    const Eigen::MatrixXd zero = Eigen::MatrixXd::Zero(Phi.cols(), X.cols());
    return parallelSum(X.rows(), zero, [&](Index begin, Index end) -> Eigen::MatrixXd {
        const Index rows = end - begin;
        return Phi.middleRows(begin, rows).transpose() *
               (D.segment(begin, rows).asDiagonal() * X.middleRows(begin, rows));
    });
}

/// Its inverse, Phi c.
Eigen::MatrixXd inverseTransform(const Eigen::MatrixXd& Phi, const Eigen::MatrixXd& c) {
    Eigen::MatrixXd X(Phi.rows(), c.cols());
    parallelRows(X.rows(), [&](Index begin, Index end) {
        X.middleRows(begin, end - begin).noalias() = Phi.middleRows(begin, end - begin) * c;
    });
    return X;
}

}  // namespace

HarmonicBasis denseBasis(const Laplacian& laplacian, const ConstantModes& constants) {
    const Eigen::VectorXd invSqrtD = laplacian.D.cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd A =
        invSqrtD.asDiagonal() * Eigen::MatrixXd(laplacian.W) * invSqrtD.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(A);
    if (solver.info() != Eigen::Success)
        throw SolverFailure("the dense eigenproblem of " + std::to_string(A.rows()) +
                            " vertices did not converge");
    HarmonicBasis basis;
    basis.Phi = invSqrtD.asDiagonal() * solver.eigenvectors();
    basis.lambda = solver.eigenvalues();
    basis.lambda.head(constants.count()).setZero();
    basis.Phi.leftCols(constants.count()) = constants.orthonormal();
    return basis;
}

bool isDenseQuicker(Index n) { return n <= kDenseVertices; }

double largestEigenvalue(const Laplacian& laplacian) {
    ScaledStiffness op(laplacian);
    const Index krylov = std::min<Index>(laplacian.D.size(), 30);
    Spectra::SymEigsSolver<ScaledStiffness> solver(op, 1, krylov);
    solver.init();
    solver.compute(Spectra::SortRule::LargestAlge, kMaxRestarts, 1e-8);
    if (solver.info() != Spectra::CompInfo::Successful)
        throw SolverFailure(
            "the largest eigenvalue could not be computed: the mesh probably has degenerate "
            "triangles ('Remove Zero Area Faces')");
    return solver.eigenvalues()[0];
}

Eigen::ArrayXd gainsOf(const HarmonicBasis& basis, const Gain& gain) {
    Eigen::ArrayXd gains(basis.size());
    for (Index i = 0; i < basis.size(); ++i)
        gains[i] = gain(std::sqrt(std::max(0.0, basis.lambda[i])));
    return gains;
}

Eigen::MatrixXd applyInBasis(const HarmonicBasis& basis, const Eigen::VectorXd& D,
                             const ConstantModes& constants, const Gain& gain, double residualGain,
                             const Eigen::MatrixXd& X) {
    const Eigen::MatrixXd means = constants.means(X);
    Eigen::MatrixXd centred = X;
    constants.add(-means, centred);

    // With the manifold harmonic transform c = Phi^T D X:
    // Phi F c + F_h (X - Phi c) = F_h X + Phi (F - F_h) c.
    const Eigen::MatrixXd c = transform(basis.Phi, D, centred);
    const Eigen::VectorXd gains = gainsOf(basis, gain) - residualGain;
    Eigen::MatrixXd Y =
        residualGain * centred + inverseTransform(basis.Phi, gains.asDiagonal() * c);

    constants.remove(Y);
    constants.add(means, Y);
    return Y;
}

}  // namespace spectral
