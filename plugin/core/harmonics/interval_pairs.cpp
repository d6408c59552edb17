#include "core/harmonics/interval_pairs.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <utility>
#include <vector>

#include "core/harmonics/lanczos.h"

namespace spectral {

namespace {

/// Eigenpairs that a Lanczos run seeks beyond those of the interval: the shift is in the middle of
/// the interval, not of its eigenvalues.
constexpr Index kExtraPairs = 1;

/// Dimension of the Krylov space: twice the number of pairs, as Spectra recommends, and a few more.
constexpr Index kExtraDimension = 4, kMinDimension = 20;

/// Relative accuracy of the eigenvalues of the inverse; inverse iteration then adds a few digits.
constexpr double kTolerance = 1e-9;
constexpr int kMaxRestarts = 100;

/// Consecutive Lanczos runs without a pair in the interval after which its count must be wrong.
constexpr int kMaxFruitless = 3;

/// u -> h D^1/2 (W - sigma D)^-1 D^1/2 u on the complement of the constants and of known vectors:
/// symmetric, with eigenvalues h / (lambda - sigma). If h is the half-width of an interval around
/// sigma, the eigenvalues inside have modulus above 1, as the convergence test assumes.
class DeflatedResolvent {
  public:
    DeflatedResolvent(const Laplacian& laplacian, const ShiftedLdlt& factor, double half,
                      const Eigen::MatrixXd& known, const StopPoint& stopPoint)
        : D_(laplacian.D),
          sqrtD_(D_.cwiseSqrt()),
          constants_(laplacian.constants),
          factor_(factor),
          half_(half),
          known_(known),
          stopPoint_(stopPoint) {}

    Eigen::VectorXd operator()(const Eigen::Ref<const Eigen::VectorXd>& x) const {
        stopPoint_();
        Eigen::VectorXd u = x.cwiseQuotient(sqrtD_);
        factor_.applyResolvent(D_, u);
        constants_.remove(D_, u);
        u -= known_ * (known_.transpose() * D_.cwiseProduct(u)).eval();
        return half_ * u.cwiseProduct(sqrtD_);
    }

  private:
    const Eigen::VectorXd& D_;
    Eigen::VectorXd sqrtD_;
    const ConstantModes& constants_;
    const ShiftedLdlt& factor_;
    double half_;
    const Eigen::MatrixXd& known_;
    const StopPoint& stopPoint_;
};

void append(Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
    A.conservativeResize(B.rows(), A.cols() + B.cols());
    A.rightCols(B.cols()) = B;
}

void append(Eigen::VectorXd& a, const Eigen::VectorXd& b) {
    a.conservativeResize(a.size() + b.size());
    a.tail(b.size()) = b;
}

/// U^T D U, lower triangle only.
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

IntervalPairs computeInterval(const Laplacian& laplacian, const SpectralInterval& interval,
                              ShiftedLdlt& factor, const StopPoint& stopPoint) {
    const Eigen::VectorXd& D = laplacian.D;
    const Index n = D.size();
    factor.factorize(laplacian.W, D, interval.middle(), stopPoint);
    const double half = 0.5 * (interval.to - interval.from);
    Eigen::MatrixXd known(n, 0);
    Eigen::VectorXd lambda(0);
    std::vector<Index> inside;  // columns of `known`
    for (int fruitless = 0; static_cast<Index>(inside.size()) < interval.count;) {
        const Index missing = interval.count - static_cast<Index>(inside.size());
        const Index free = n - laplacian.constants.count() - known.cols();
        const Index wanted = std::min(missing + kExtraPairs, free - 1);
        if (wanted < 1) return {};
        const Index dimension =
            std::min(std::max(2 * wanted + kExtraDimension, kMinDimension), free);
        const DeflatedResolvent resolvent(laplacian, factor, half, known, stopPoint);
        const Eigenpairs nearest =
            largestPairs(resolvent, n, wanted, {dimension, kMaxRestarts, kTolerance});
        Eigen::MatrixXd U = D.cwiseSqrt().cwiseInverse().asDiagonal() * nearest.vectors;
        // One more inverse iteration reduces the error outside the Krylov space.
        factor.applyResolvent(D, U);
        laplacian.constants.remove(laplacian.D, U);
        if (orthonormalize(D, known, U) < kOwnPart) return {};
        append(known, U);
        append(lambda, factor.shift() + half * nearest.values.array().inverse());
        const std::size_t before = inside.size();
        for (Index i = lambda.size() - U.cols(); i < lambda.size(); ++i)
            if (lambda[i] >= interval.from && lambda[i] < interval.to) inside.push_back(i);
        fruitless = inside.size() == before ? fruitless + 1 : 0;
        if (fruitless == kMaxFruitless) return {};
    }
    if (static_cast<Index>(inside.size()) > interval.count) return {};
    std::sort(inside.begin(), inside.end(),
              [&](Index a, Index b) { return lambda[a] < lambda[b]; });
    return {known(Eigen::indexing::all, inside), lambda(inside)};
}

}  // namespace spectral
