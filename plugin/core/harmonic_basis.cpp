#include "harmonic_basis.h"

#include <Spectra/SymEigsSolver.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "basis_certificate.h"
#include "basis_transform.h"
#include "errors.h"
#include "shifted_ldlt.h"
#include "spectrum_slicing.h"

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

/// The first `size` pairs of a basis, with their certificate.
HarmonicBasis certified(const Laplacian& laplacian, Index constants, HarmonicBasis basis,
                        Index size, ShiftedCholesky& cholesky, ShiftedLdlt& factor,
                        const Progress& progress) {
    std::optional<double> cut;
    if (size < basis.size()) cut = 0.5 * (basis.lambda[size - 1] + basis.lambda[size]);
    basis.Phi.conservativeResize(Eigen::NoChange, size);
    basis.lambda.conservativeResize(size);
    basis.inertiaCount = size;  // where it holds all that there are
    measureBasis(
        laplacian, constants, basis,
        [&] {
            if (!cut) return;
            factor.factorize(laplacian, *cut);
            basis.inertiaCount = factor.eigenvaluesBelow();
        },
        progress);
    if (cut) cholesky.countWork(1, 0);
    // Sylvester's law of inertia: none is missing below the cut.
    if (basis.inertiaCount != size)
        throw SolverFailure("of the " + std::to_string(basis.inertiaCount) +
                            " harmonics that the inertia of W - sigma D counts, " +
                            std::to_string(size) + " were found; choose another basis_size");
    return basis;
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

HarmonicBasis truncatedBasis(const Laplacian& laplacian, const ConstantModes& constants, Index k,
                             ShiftedCholesky& cholesky, const Progress& progress) {
    std::vector<ShiftedLdlt> factors;
    return truncatedBasis(laplacian, constants, k, cholesky, factors, progress);
}

HarmonicBasis truncatedBasis(const Laplacian& laplacian, const ConstantModes& constants, Index k,
                             ShiftedCholesky& cholesky, std::vector<ShiftedLdlt>& factors,
                             const Progress& progress) {
    const Index n = laplacian.D.size(), c = constants.count();
    if (k >= n)
        throw InvalidOption("basis_size = " + std::to_string(k) + " needs more than " +
                            std::to_string(k) + " vertices; the mesh has " + std::to_string(n) +
                            ": choose a smaller basis_size");
    if (k <= c)
        throw InvalidOption("basis_size = " + std::to_string(k) +
                            " holds no more than the constant modes of the " + std::to_string(c) +
                            " connected components: choose a basis_size above " +
                            std::to_string(c));

    if (isDenseQuicker(n)) {
        HarmonicBasis all = denseBasis(laplacian, constants);
        const Index size = cutOutsideClusters(all.lambda, k).value_or(n);
        ShiftedLdlt factor;
        return certified(laplacian, c, std::move(all), size, cholesky, factor, progress);
    }
    // Some pairs beyond k show whether k cuts a cluster; more are taken while it does.
    for (Index more = 8;; more *= 2) {
        const Index total = std::min(k + more, n - 1);
        LowestPairs pairs =
            lowestPairs(laplacian, constants, total, factors, progress.part(0.0, 0.95));
        cholesky.countWork(pairs.factorizations, pairs.solves);
        HarmonicBasis basis;
        basis.Phi = std::move(pairs.Phi);
        basis.lambda = std::move(pairs.lambda);
        std::optional<Index> size = cutOutsideClusters(basis.lambda, k);
        if (!size) {
            if (total < n - 1) continue;
            size = basis.size();  // nothing left to cut off
        }
        return certified(laplacian, c, std::move(basis), *size, cholesky, factors.front(),
                         progress.part(0.95, 1.0));
    }
}

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
    const Eigen::VectorXd gains = gainsOf(basis, gain) - residualGain;
    Eigen::MatrixXd Y = residualGain * centred;
    Y += inverseHarmonicTransform(basis.Phi,
                                  gains.asDiagonal() * harmonicTransform(basis.Phi, D, centred));

    constants.remove(Y);
    constants.add(means, Y);
    return Y;
}

}  // namespace spectral
