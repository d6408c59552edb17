#include "harmonic_basis.h"

#include <Spectra/SymEigsShiftSolver.h>
#include <Spectra/SymEigsSolver.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>

#include "errors.h"

namespace spectral {

namespace {

/// The shift below zero, in units of the first eigenvalues' scale 4 pi / area (Weyl's law).
constexpr double kShift = 0.1;

/// Relative accuracy of the eigenvalues asked of the iteration.
constexpr double kTolerance = 1e-11;

constexpr int kMaxRestarts = 300;

/// Searches for missed copies of multiple eigenvalues before giving up.
constexpr int kMaxSearches = 5;

/// Neighbouring eigenvalues nearer than this part of the mean spacing lambda_k / k (Weyl's law)
/// belong to one cluster: equal ones by symmetry, told apart by the mesh or by round-off only.
constexpr double kClusterSpacing = 0.1;

/// Symmetric operator of the shift-inverted problem, D^1/2 (W - sigma D)^-1 D^1/2, on the
/// complement of the constant modes and of `known` (n x p, D-orthonormal).
class ShiftInvert {
  public:
    using Scalar = double;

    ShiftInvert(const Laplacian& laplacian, const ConstantModes& constants,
                const ShiftedCholesky& cholesky, const Eigen::MatrixXd& known,
                const Progress& progress, double expectedSolves)
        : D_(laplacian.D),
          sqrtD_(laplacian.D.cwiseSqrt()),
          constants_(constants),
          cholesky_(cholesky),
          known_(known),
          progress_(progress),
          expectedSolves_(expectedSolves) {}

    Index rows() const { return D_.size(); }
    Index cols() const { return D_.size(); }
    void set_shift(double) {}  // the factorization is made before

    void perform_op(const double* in, double* out) const {
        Eigen::MatrixXd u = Eigen::Map<const Eigen::VectorXd>(in, rows()).cwiseQuotient(sqrtD_);
        project(u);
        u = cholesky_.solve(D_.asDiagonal() * u);
        project(u);
        Eigen::Map<Eigen::VectorXd>(out, rows()) = sqrtD_.cwiseProduct(u.col(0));
        // The number of solves is not known beforehand: approach 1 without reaching it.
        solves_ += 1.0;
        progress_.report(solves_ / (solves_ + expectedSolves_), "computing the harmonics");
    }

  private:
    void project(Eigen::MatrixXd& u) const {
        constants_.remove(u);
        if (known_.cols() > 0) u -= known_ * (known_.transpose() * (D_.asDiagonal() * u));
    }

    const Eigen::VectorXd& D_;
    Eigen::VectorXd sqrtD_;
    const ConstantModes& constants_;
    const ShiftedCholesky& cholesky_;
    const Eigen::MatrixXd& known_;
    const Progress& progress_;
    double expectedSolves_;
    mutable double solves_ = 0.0;
};

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

[[noreturn]] void failed(Spectra::CompInfo info, const char* what) {
    if (info == Spectra::CompInfo::NotConverging)
        throw SolverFailure(std::string(what) +
                            ": the Lanczos iteration did not converge; choose a smaller basis_size "
                            "or spectrum = full");
    throw SolverFailure(std::string(what) +
                        ": numerical failure in the Lanczos iteration; the mesh probably has "
                        "degenerate triangles ('Remove Zero Area Faces')");
}

/// The `wanted` lowest eigenpairs outside the constants and outside `known`, unordered.
HarmonicBasis lowestPairs(const Laplacian& laplacian, const ConstantModes& constants,
                          const ShiftedCholesky& cholesky, double sigma,
                          const Eigen::MatrixXd& known, Index wanted, const Progress& progress) {
    const Index n = laplacian.D.size();
    const Index krylov = std::min(n, std::max<Index>(2 * wanted + 1, 20));
    ShiftInvert op(laplacian, constants, cholesky, known, progress,
                   3.0 * static_cast<double>(wanted));
    Spectra::SymEigsShiftSolver<ShiftInvert> solver(op, wanted, krylov, sigma);
    solver.init();  // Spectra's own start vector: pseudo-random with a fixed seed
    solver.compute(Spectra::SortRule::LargestMagn, kMaxRestarts, kTolerance);
    if (solver.info() != Spectra::CompInfo::Successful)
        failed(solver.info(), "the harmonics could not be computed");
    return {laplacian.D.cwiseSqrt().cwiseInverse().asDiagonal() * solver.eigenvectors(),
            solver.eigenvalues()};
}

/// Appends the pairs of `more` and sorts all by eigenvalue.
HarmonicBasis merged(const HarmonicBasis& basis, const HarmonicBasis& more) {
    const Index n = std::max(basis.Phi.rows(), more.Phi.rows());
    Eigen::VectorXd lambda(basis.size() + more.size());
    lambda << basis.lambda, more.lambda;
    std::vector<Index> order(static_cast<std::size_t>(lambda.size()));
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](Index i, Index j) { return lambda[i] < lambda[j]; });
    HarmonicBasis all{Eigen::MatrixXd(n, lambda.size()), Eigen::VectorXd(lambda.size())};
    for (Index i = 0; i < lambda.size(); ++i) {
        const Index from = order[i];
        all.lambda[i] = lambda[from];
        all.Phi.col(i) =
            from < basis.size() ? basis.Phi.col(from) : more.Phi.col(from - basis.size());
    }
    return all;
}

/// The number of pairs, from `asked` on, at which a spectrum may be cut; empty when every candidate
/// lies inside a cluster. `lambda` ascends and has more than `asked` entries.
std::optional<Index> cutOutsideClusters(const Eigen::VectorXd& lambda, Index asked) {
    const double spacing = lambda[asked - 1] / static_cast<double>(asked);
    for (Index k = asked; k < lambda.size(); ++k)
        if (lambda[k] - lambda[k - 1] > kClusterSpacing * spacing) return k;
    return std::nullopt;
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
    HarmonicBasis basis{invSqrtD.asDiagonal() * solver.eigenvectors(), solver.eigenvalues()};
    basis.lambda.head(constants.count()).setZero();
    basis.Phi.leftCols(constants.count()) = constants.orthonormal();
    return basis;
}

HarmonicBasis truncatedBasis(const Laplacian& laplacian, const ConstantModes& constants, Index k,
                             ShiftedCholesky& cholesky, const Progress& progress) {
    const Index n = laplacian.D.size(), c = constants.count();
    if (k >= n)
        throw InvalidOption("basis_size = " + std::to_string(k) + " needs more than " +
                            std::to_string(k) + " vertices; the mesh has " + std::to_string(n) +
                            ": choose a smaller basis_size, or spectrum = full");
    if (k <= c)
        throw InvalidOption("basis_size = " + std::to_string(k) +
                            " holds no more than the constant modes of the " + std::to_string(c) +
                            " connected components: choose a basis_size above " +
                            std::to_string(c) + ", or spectrum = full");

    const double sigma = -kShift * 4.0 * kPi / laplacian.D.sum();
    progress.report(0.0, "factorizing");
    cholesky.factorize(laplacian, -sigma);

    const HarmonicBasis constant{constants.orthonormal(), Eigen::VectorXd::Zero(c)};
    HarmonicBasis found{Eigen::MatrixXd(n, 0), Eigen::VectorXd(0)};
    int searches = 0;
    // Some pairs beyond k show whether k cuts a cluster; more are taken while it does.
    for (Index guard = std::max<Index>(8, k / 20);; guard *= 2) {
        const Index total = std::min(k + guard, n - 1);
        const Index wanted = total - c - found.size();
        if (wanted > 0)
            found = merged(found, lowestPairs(laplacian, constants, cholesky, sigma, found.Phi,
                                              wanted, progress));
        HarmonicBasis basis = merged(constant, found);

        std::optional<Index> cut = cutOutsideClusters(basis.lambda, k);
        if (!cut) {
            if (total < n - 1) continue;
            cut = total;  // nothing left to cut off but the last one
        }
        if (*cut < basis.size()) {
            // Sylvester's law of inertia: a Lanczos run can miss copies of a multiple eigenvalue.
            const double between = 0.5 * (basis.lambda[*cut - 1] + basis.lambda[*cut]);
            const Index missing = cholesky.countEigenvaluesBelow(laplacian, between) - *cut;
            if (missing > 0) {
                if (++searches > kMaxSearches)
                    throw SolverFailure(
                        "the basis misses " + std::to_string(missing) +
                        " of the harmonics that the inertia of W - sigma D counts; choose another "
                        "basis_size, or spectrum = full");
                found = merged(found, lowestPairs(laplacian, constants, cholesky, sigma, found.Phi,
                                                  missing, progress));
                guard = (guard + 1) / 2;
                continue;
            }
        }
        basis.Phi.conservativeResize(Eigen::NoChange, *cut);
        basis.lambda.conservativeResize(*cut);
        return basis;
    }
}

double largestEigenvalue(const Laplacian& laplacian) {
    ScaledStiffness op(laplacian);
    const Index krylov = std::min<Index>(laplacian.D.size(), 30);
    Spectra::SymEigsSolver<ScaledStiffness> solver(op, 1, krylov);
    solver.init();
    solver.compute(Spectra::SortRule::LargestAlge, kMaxRestarts, 1e-8);
    if (solver.info() != Spectra::CompInfo::Successful)
        failed(solver.info(), "the largest eigenvalue could not be computed");
    return solver.eigenvalues()[0];
}

Eigen::MatrixXd applyInBasis(const HarmonicBasis& basis, const Eigen::VectorXd& D,
                             const ConstantModes& constants, const Gain& gain, double residualGain,
                             const Eigen::MatrixXd& X) {
    const Eigen::MatrixXd means = constants.means(X);
    Eigen::MatrixXd centred = X;
    constants.add(-means, centred);

    // With the manifold harmonic transform c = Phi^T D X:
    // Phi F c + F_h (X - Phi c) = F_h X + Phi (F - F_h) c.
    const Eigen::MatrixXd spectrum = basis.Phi.transpose() * (D.asDiagonal() * centred);
    Eigen::VectorXd gains(basis.size());
    for (Index i = 0; i < basis.size(); ++i)
        gains[i] = gain(std::sqrt(std::max(0.0, basis.lambda[i]))) - residualGain;
    Eigen::MatrixXd Y = residualGain * centred;
    Y.noalias() += basis.Phi * (gains.asDiagonal() * spectrum);

    constants.remove(Y);
    constants.add(means, Y);
    return Y;
}

}  // namespace spectral
