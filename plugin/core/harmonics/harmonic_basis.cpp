#include "core/harmonics/harmonic_basis.h"

#include <Eigen/Jacobi>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "core/harmonics/lanczos.h"
#include "core/mesh/mesh.h"
#include "core/support/dense_solvers.h"
#include "core/support/errors.h"

namespace spectral {

namespace {

/// Largest number of vertices for the dense solver. Below it, spectrum slicing is no faster: its
/// Krylov spaces must be small compared with n.
constexpr Index kMaxDenseVertices = 300;

/// Lanczos restarts for the largest eigenvalue; many, as no shift speeds up convergence.
constexpr int kMaxRestarts = 300;

/// Eigenvectors of a positive semidefinite matrix, in any order, by Jacobi rotations: each
/// eigenvalue is accurate relative to itself, whereas methods that first tridiagonalize have
/// round-off relative to the largest in all of them (Demmel and Veselic 1992). Diagonalizes A.
Eigen::MatrixXd jacobiEigenvectors(Eigen::MatrixXd& A) {
    constexpr double kRoundOff = 1e-15;
    constexpr int kMaxSweeps = 60;  // convergence is quadratic: ten are plenty
    Eigen::MatrixXd Q = Eigen::MatrixXd::Identity(A.rows(), A.cols());
    for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
        bool isDiagonal = true;
        for (Index q = 1; q < A.cols(); ++q) {
            for (Index p = 0; p < q; ++p) {
                const double product = std::sqrt(std::abs(A(p, p))) * std::sqrt(std::abs(A(q, q)));
                if (std::abs(A(p, q)) <= kRoundOff * product) continue;
                isDiagonal = false;
                Eigen::JacobiRotation<double> rotation;
                rotation.makeJacobi(A, p, q);
                A.applyOnTheLeft(p, q, rotation.adjoint());
                A.applyOnTheRight(p, q, rotation);
                A(p, q) = A(q, p) = 0.0;
                Q.applyOnTheRight(p, q, rotation);
            }
        }
        if (isDiagonal) return Q;
    }
    throw SolverFailure("Jacobi's method did not converge for " + std::to_string(A.rows()) +
                        " harmonics");
}

/// Refines eigenvectors whose round-off is relative to the largest eigenvalue, by Rayleigh-Ritz,
/// and sorts them; returns their eigenvalues. Phi^T W Phi is computed from differences along edges:
/// with needle triangles, most digits of W Phi would cancel.
Eigen::VectorXd refine(const Laplacian& laplacian, Eigen::MatrixXd& Phi) {
    const SparseMatrix& W = laplacian.W;
    const Index n = W.rows();
    const Eigen::VectorXd sums = W * Eigen::VectorXd::Ones(n);
    Eigen::MatrixXd differences((W.nonZeros() + n) / 2, Phi.cols());
    Eigen::VectorXd weight(differences.rows());
    Index edge = 0;
    for (Index j = 0; j < n; ++j) {
        for (SparseMatrix::InnerIterator entry(W, j); entry.row() < j; ++entry, ++edge) {
            differences.row(edge) = Phi.row(j) - Phi.row(entry.row());
            weight[edge] = -entry.value();
        }
        differences.row(edge) = Phi.row(j);
        weight[edge++] = laplacian.constants.label()[j] < 0 ? sums[j] : 0.0;
    }
    Eigen::MatrixXd ritz = differences.transpose() * weight.asDiagonal() * differences;
    const Eigen::MatrixXd Q = Phi * jacobiEigenvectors(ritz);
    std::vector<Index> order(static_cast<std::size_t>(ritz.cols()));
    std::iota(order.begin(), order.end(), Index{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](Index a, Index b) { return ritz(a, a) < ritz(b, b); });
    Phi = Q(Eigen::indexing::all, order);
    return ritz.diagonal()(order);
}

}  // namespace

Eigen::MatrixXd HarmonicBasis::transform(const Eigen::VectorXd& D, const Eigen::MatrixXd& X) const {
    const Eigen::MatrixXd DX = D.asDiagonal() * X;  // Kovnatsky et al. 2012, Eq. 6
    return Phi.transpose() * DX;
}

Eigen::MatrixXd HarmonicBasis::inverseTransform(const Eigen::MatrixXd& c) const { return Phi * c; }

HarmonicBasis denseBasis(const Laplacian& laplacian) {
    const Eigen::VectorXd sqrtD = laplacian.D.cwiseSqrt(), invSqrtD = sqrtD.cwiseInverse();
    Eigen::MatrixXd A =
        invSqrtD.asDiagonal() * Eigen::MatrixXd(laplacian.W) * invSqrtD.asDiagonal();
    // The constant modes are known: move them to the end of the spectrum, or they would mix with
    // eigenvectors of almost zero eigenvalues.
    const Index varying = A.rows() - laplacian.constants.count();
    const double bound = A.cwiseAbs().rowwise().sum().maxCoeff();
    const Eigen::MatrixXd C = sqrtD.asDiagonal() * laplacian.constants.orthonormal();
    for (const Eigen::VectorXd c : C.colwise()) {  // (I - c c^T) A (I - c c^T) + 2 bound c c^T
        const Eigen::VectorXd Ac = A.selfadjointView<Eigen::Lower>() * c;
        A.selfadjointView<Eigen::Lower>().rankUpdate(c, (0.5 * c.dot(Ac) + bound) * c - Ac);
    }
    Eigen::MatrixXd Phi = invSqrtD.asDiagonal() * symmetricPairs(A).vectors.leftCols(varying);
    const Eigen::VectorXd lambda = refine(laplacian, Phi);
    HarmonicBasis basis;
    basis.Phi.resize(A.rows(), A.rows());
    basis.Phi << laplacian.constants.orthonormal(), Phi;
    basis.lambda.resize(A.rows());
    basis.lambda << Eigen::VectorXd::Zero(laplacian.constants.count()), lambda;
    return basis;
}

bool isDenseQuicker(Index n) { return n <= kMaxDenseVertices; }

double largestEigenvalue(const Laplacian& laplacian) {
    const Eigen::VectorXd invSqrtD = laplacian.D.cwiseSqrt().cwiseInverse();
    SparseMatrix A = invSqrtD.asDiagonal() * laplacian.W * invSqrtD.asDiagonal();
    // Spectra's convergence test assumes eigenvalues of about 1: divide by Gershgorin's bound.
    const double bound = (A.cwiseAbs() * Eigen::VectorXd::Ones(A.cols())).maxCoeff();
    // Spectra starts from A times a random vector. If one eigenvalue is far above all others, this
    // is an eigenvector with a residual of round-off (yixuan/spectra#159). A + I avoids that: its
    // eigenvalues are in [1, 2].
    A = A / bound;
    const auto shifted = [&A](const Eigen::Ref<const Eigen::VectorXd>& x) -> Eigen::VectorXd {
        return A * x + x;
    };
    const LanczosOptions options{std::min<Index>(A.rows(), 30), kMaxRestarts, 1e-8};
    try {
        return bound * (largestPairs(shifted, A.rows(), 1, options).values[0] - 1.0);
    } catch (const SolverFailure&) {
        throw SolverFailure(ErrorCode::SingularMatrix,
                            "the largest eigenvalue could not be computed");
    }
}

Eigen::MatrixXd applyInBasis(const HarmonicBasis& basis, const Laplacian& laplacian,
                             const Gain& gain, double residualGain, const Eigen::MatrixXd& X) {
    const Eigen::MatrixXd means = laplacian.constants.means(laplacian.D, X);
    Eigen::MatrixXd centred = X;
    laplacian.constants.add(-means, centred);

    // Kovnatsky et al. 2012, Eqs. 6 to 10: Phi F c + F_h (X - Phi c) = F_h X + Phi (F - F_h) c.
    Eigen::MatrixXd c = basis.transform(laplacian.D, centred);
    for (Index i = 0; i < basis.size(); ++i)
        c.row(i) *= gain(std::sqrt(std::max(0.0, basis.lambda[i]))) - residualGain;
    Eigen::MatrixXd Y = residualGain * centred + basis.inverseTransform(c);
    laplacian.constants.remove(laplacian.D, Y);
    laplacian.constants.add(means, Y);
    return Y;
}

}  // namespace spectral
