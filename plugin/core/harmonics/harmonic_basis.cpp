#include "core/harmonics/harmonic_basis.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "core/harmonics/lanczos.h"
#include "core/mesh/mesh.h"
#include "core/support/errors.h"

namespace spectral {

namespace {

/// Up to this many vertices the dense solver is about as fast as spectral intervals, whose Krylov
/// spaces must be small compared with n.
constexpr Index kDenseVertices = 300;

/// Restarts of Lanczos' method for the largest eigenvalue, which has no shift to speed it up.
constexpr int kMostRestarts = 300;

using DenseSolver = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>;

DenseSolver solved(const Eigen::MatrixXd& A) {
    DenseSolver solver(A);
    if (solver.info() == Eigen::Success) return solver;
    throw SolverFailure("the dense eigenproblem of " + std::to_string(A.rows()) +
                        " vertices did not converge");
}

/// Eigenvectors of a positive semidefinite matrix, in any order, by Jacobi's rotations: each
/// eigenvalue to its own relative accuracy, where methods that begin with a tridiagonal matrix
/// spread round-off of the largest over all (Demmel and Veselic 1992). A becomes diagonal.
Eigen::MatrixXd jacobiEigenvectors(Eigen::MatrixXd& A) {
    constexpr double kRoundOff = 1e-15;
    constexpr int kMostSweeps = 60;  // converges quadratically: ten are many
    Eigen::MatrixXd Q = Eigen::MatrixXd::Identity(A.rows(), A.cols());
    for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
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
    throw SolverFailure("the dense eigenproblem of " + std::to_string(A.rows()) +
                        " harmonics did not converge");
}

/// Makes eigenvectors accurate whose errors are round-off relative to the largest eigenvalue, by
/// Rayleigh-Ritz, and sorts them; returns their eigenvalues. Phi^T W Phi is computed from
/// differences along edges: among needles, most digits of W Phi would cancel.
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
    Phi = Q(Eigen::all, order);
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
    // The constants, which are known, become the last: eigenvectors of eigenvalues near theirs
    // would be mixtures with them.
    const Index varying = A.rows() - laplacian.constants.count();
    const double bound = A.cwiseAbs().rowwise().sum().maxCoeff();
    const Eigen::MatrixXd C = sqrtD.asDiagonal() * laplacian.constants.orthonormal();
    for (const Eigen::VectorXd c : C.colwise()) {  // (I - c c^T) A (I - c c^T) + 2 bound c c^T
        const Eigen::VectorXd Ac = A.selfadjointView<Eigen::Lower>() * c;
        A.selfadjointView<Eigen::Lower>().rankUpdate(c, (0.5 * c.dot(Ac) + bound) * c - Ac);
    }
    Eigen::MatrixXd Phi = invSqrtD.asDiagonal() * solved(A).eigenvectors().leftCols(varying);
    const Eigen::VectorXd lambda = refine(laplacian, Phi);
    HarmonicBasis basis;
    basis.Phi.resize(A.rows(), A.rows());
    basis.Phi << laplacian.constants.orthonormal(), Phi;
    basis.lambda.resize(A.rows());
    basis.lambda << Eigen::VectorXd::Zero(laplacian.constants.count()), lambda;
    return basis;
}

bool isDenseQuicker(Index n) { return n <= kDenseVertices; }

double largestEigenvalue(const Laplacian& laplacian) {
    const Eigen::VectorXd invSqrtD = laplacian.D.cwiseSqrt().cwiseInverse();
    SparseMatrix A = invSqrtD.asDiagonal() * laplacian.W * invSqrtD.asDiagonal();
    // Spectra's test for convergence assumes eigenvalues of about 1. Gershgorin's bound:
    const double bound = (A.cwiseAbs() * Eigen::VectorXd::Ones(A.cols())).maxCoeff();
    // Spectra starts from A times a random vector: where one eigenvalue is far above all others, an
    // eigenvector, with a residual of round-off (yixuan/spectra#159). Those of A + I are in [1, 2].
    A = A / bound;
    const auto shifted = [&A](const Eigen::Ref<const Eigen::VectorXd>& x) -> Eigen::VectorXd {
        return A * x + x;
    };
    const LanczosOptions options{std::min<Index>(A.rows(), 30), kMostRestarts, 1e-8};
    try {
        return bound * (largestPairs(shifted, A.rows(), 1, options).values[0] - 1.0);
    } catch (const SolverFailure&) {
        throw SolverFailure(ErrorCode::SingularMatrix,
                            "the largest eigenvalue could not be computed");
    }
}

Eigen::MatrixXd applyInBasis(const HarmonicBasis& basis, const Laplacian& laplacian,
                             const Gain& gain, double residualGain, const Eigen::MatrixXd& X) {
    const Eigen::MatrixXd means = laplacian.constants.means(X);
    Eigen::MatrixXd centred = X;
    laplacian.constants.add(-means, centred);

    // Kovnatsky et al. 2012, Eqs. 6 to 10: Phi F c + F_h (X - Phi c) = F_h X + Phi (F - F_h) c.
    Eigen::MatrixXd c = basis.transform(laplacian.D, centred);
    for (Index i = 0; i < basis.size(); ++i)
        c.row(i) *= gain(std::sqrt(std::max(0.0, basis.lambda[i]))) - residualGain;
    Eigen::MatrixXd Y = residualGain * centred + basis.inverseTransform(c);
    laplacian.constants.remove(Y);
    laplacian.constants.add(means, Y);
    return Y;
}

}  // namespace spectral
