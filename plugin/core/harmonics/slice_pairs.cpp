#include "core/harmonics/slice_pairs.h"

#include <Spectra/SymEigsSolver.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <exception>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "core/laplacian/constant_modes.h"
#include "core/support/errors.h"

namespace spectral {

namespace {

/// Eigenpairs that a run of Spectra is to find beside those of the slice: the shift is in the
/// middle of the slice, not of its eigenvalues.
constexpr Index kBeside = 1;

/// Dimension of the Krylov space: Spectra's advice is twice the number of pairs at least.
constexpr Index kSpareDimension = 4, kLeastDimension = 20;

/// Relative accuracy of eigenvalues of the inverse. The vectors gain some digits more afterwards.
constexpr double kTolerance = 1e-9;
constexpr int kMaxRestarts = 100;

/// Runs without a pair of the slice after which its count is taken for wrong.
constexpr int kFruitless = 3;

/// u -> D^1/2 (W - sigma D)^-1 D^1/2 u on the complement of the constants and of known vectors:
/// symmetric, with eigenvalues 1 / (lambda - sigma).
class DeflatedResolvent {
  public:
    using Scalar = double;

    DeflatedResolvent(const Laplacian& laplacian, const ConstantModes& constants,
                      const ShiftedLdlt& factor, const Eigen::MatrixXd& known,
                      const StopPoint& stopPoint)
        : D_(laplacian.D),
          sqrtD_(D_.cwiseSqrt()),
          constants_(constants),
          factor_(factor),
          known_(known),
          stopPoint_(stopPoint) {}

    Index rows() const { return D_.size(); }
    Index cols() const { return D_.size(); }

    void perform_op(const double* in, double* out) const {
        stopPoint_();
        Eigen::VectorXd u = Eigen::Map<const Eigen::VectorXd>(in, rows()).cwiseQuotient(sqrtD_);
        factor_.applyResolvent(D_, u);
        constants_.remove(u);
        u -= known_ * (known_.transpose() * D_.cwiseProduct(u)).eval();
        Eigen::Map<Eigen::VectorXd>(out, rows()) = u.cwiseProduct(sqrtD_);
    }

  private:
    const Eigen::VectorXd& D_;
    Eigen::VectorXd sqrtD_;
    const ConstantModes& constants_;
    const ShiftedLdlt& factor_;
    const Eigen::MatrixXd& known_;
    const StopPoint& stopPoint_;
};

struct Eigenpairs {
    Eigen::VectorXd values;
    Eigen::MatrixXd vectors;
};

/// Those of the largest modulus, which are nearest to the shift.
Eigenpairs nearestPairs(DeflatedResolvent& op, Index wanted, Index dimension) {
    try {
        Spectra::SymEigsSolver<DeflatedResolvent> solver(op, wanted, dimension);
        solver.init();
        if (solver.compute(Spectra::SortRule::LargestMagn, kMaxRestarts, kTolerance) > 0)
            return {solver.eigenvalues(), solver.eigenvectors()};
    } catch (const Error&) {
        throw;
    } catch (const std::exception& error) {  // Spectra's own, of a breakdown
        throw SolverFailure(std::string("the harmonics could not be computed: ") + error.what());
    }
    throw SolverFailure("the harmonics of a part of the spectrum did not converge");
}

Eigen::MatrixXd columnsOf(const Eigen::MatrixXd& A, const std::vector<Index>& columns) {
    Eigen::MatrixXd B(A.rows(), static_cast<Index>(columns.size()));
    for (Index j = 0; j < B.cols(); ++j) B.col(j) = A.col(columns[static_cast<std::size_t>(j)]);
    return B;
}

void append(Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
    A.conservativeResize(B.rows(), A.cols() + B.cols());
    A.rightCols(B.cols()) = B;
}

void append(Eigen::VectorXd& a, const Eigen::VectorXd& b) {
    a.conservativeResize(a.size() + b.size());
    a.tail(b.size()) = b;
}

std::vector<Index> ascending(const Eigen::VectorXd& lambda) {
    std::vector<Index> order(static_cast<std::size_t>(lambda.size()));
    std::iota(order.begin(), order.end(), Index{0});
    std::sort(order.begin(), order.end(), [&](Index a, Index b) { return lambda[a] < lambda[b]; });
    return order;
}

/// U^T D U; the lower half alone.
Eigen::MatrixXd gramOf(const Eigen::VectorXd& D, const Eigen::Ref<const Eigen::MatrixXd>& U) {
    const Eigen::MatrixXd scaled = D.cwiseSqrt().asDiagonal() * U;
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(U.cols(), U.cols());
    gram.selfadjointView<Eigen::Lower>().rankUpdate(scaled.transpose());
    return gram;
}

}  // namespace

double orthonormalize(const Eigen::VectorXd& D, const Eigen::Ref<const Eigen::MatrixXd>& known,
                      Eigen::Ref<Eigen::MatrixXd> U) {
    U = U * (D.transpose() * U.cwiseAbs2()).cwiseSqrt().cwiseInverse().asDiagonal();
    if (known.cols() > 0) U -= known * (known.transpose() * (D.asDiagonal() * U)).eval();
    const Eigen::LLT<Eigen::MatrixXd> gram(gramOf(D, U));
    if (gram.info() != Eigen::Success) return 0.0;
    const Eigen::MatrixXd R = gram.matrixU();
    R.triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(U);
    return R.diagonal().minCoeff();
}

SlicePairs computeSlice(const Laplacian& laplacian, const ConstantModes& constants,
                        const SpectrumSlice& slice, ShiftedLdlt& factor,
                        const StopPoint& stopPoint) {
    const Eigen::VectorXd& D = laplacian.D;
    const Index n = D.size();
    factor.factorize(laplacian, slice.middle());
    SlicePairs pairs;
    Eigen::MatrixXd known(n, 0), Phi(n, 0);
    int fruitless = 0;
    while (Phi.cols() < slice.count) {
        const Index free = n - constants.count() - known.cols();
        const Index wanted = std::min(slice.count - Phi.cols() + kBeside, free - 1);
        if (wanted < 1) return {};
        const Index dimension =
            std::min(std::max(2 * wanted + kSpareDimension, kLeastDimension), free);
        DeflatedResolvent op(laplacian, constants, factor, known, stopPoint);
        auto [lambda, U] = nearestPairs(op, wanted, dimension);
        lambda = factor.shift() + lambda.cwiseInverse().array();
        U = D.cwiseSqrt().cwiseInverse().asDiagonal() * U;
        // One more inverse iteration takes away what is not in the Krylov space.
        factor.applyResolvent(D, U);
        constants.remove(U);
        if (orthonormalize(D, known, U) < kOwnPart) return {};
        append(known, U);
        std::vector<Index> inside;
        for (Index i = 0; i < lambda.size(); ++i)
            if (lambda[i] >= slice.from && lambda[i] < slice.to) inside.push_back(i);
        fruitless = inside.empty() ? fruitless + 1 : 0;
        if (fruitless == kFruitless) return {};
        append(Phi, columnsOf(U, inside));
        append(pairs.lambda, columnsOf(lambda.transpose(), inside).transpose());
    }
    if (Phi.cols() > slice.count) return {};
    const std::vector<Index> order = ascending(pairs.lambda);
    pairs.Phi = columnsOf(Phi, order);
    pairs.lambda = columnsOf(pairs.lambda.transpose(), order).transpose().eval();
    return pairs;
}

}  // namespace spectral
