#include "core/filter/automatic_steps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "core/filter/fractional_steps.h"
#include "core/mesh/mesh.h"
#include "core/support/errors.h"
#include "core/support/threads.h"

namespace spectral {

namespace {

/// Factor by which the errors of a second-order method shrink from one pass to the next.
constexpr double kSecondOrder = 4.0;

/// Smallest factor by which distances shrink that counts as convergence.
constexpr double kMinShrinking = 1.25;

/// Passes of this many steps and more are extrapolated: errors of fewer steps shrink too unevenly
/// for the result of it to have an error that could be estimated. One that stagnates counts as
/// singular: a second-order error would have shrunk 64 times since the first pass.
constexpr int kManySteps = 8;

/// Fraction of its area below which a vertex belongs to a part that collapses.
constexpr double kCollapsed = 0.1;

/// Failing steps are halved down to 1 / kFinest of the filter, however few steps a pass has.
constexpr int kFinest = 64;

/// A shape, as its displacement from X: for distances and areas single precision will do.
using Displacement = Eigen::Matrix<float, Eigen::Dynamic, 3>;

/// Norms of the rows of A - B.
Eigen::VectorXd distances(const Vertices& A, const Vertices& B) {
    Eigen::VectorXd length(A.rows());
    parallelRows(A.rows(), [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) length[i] = (A.row(i) - B.row(i)).norm();
    });
    return length;
}

/// The smallest length that is exceeded on at most kNegligibleArea of the total mass D.
double largestButNegligible(const Eigen::VectorXd& length, const Eigen::VectorXd& D) {
    std::vector<int> order(static_cast<std::size_t>(length.size()));
    std::iota(order.begin(), order.end(), 0);
    const auto isLonger = [&](int i, int j) { return length[i] > length[j]; };
    // A few vertices usually have that much mass: sort only these, or four times as many if needed.
    for (std::size_t count = order.size() / 256 + 1;; count *= 4) {
        const auto end = order.begin() + static_cast<Index>(std::min(count, order.size()));
        std::nth_element(order.begin(), end - 1, order.end(), isLonger);
        std::sort(order.begin(), end, isLonger);
        double left = kNegligibleArea * D.sum();
        for (auto i = order.begin(); i != end; ++i)
            if ((left -= D[*i]) < 0.0) return length[*i];
        if (end == order.end()) return 0.0;
    }
}

/// Limit of the shapes Y_1, Y_2, Y_4, ..., and how far the last one is from it.
///
/// All constants are fits to eleven meshes at 1, 5, 15 and 30 %, low-passes, bands and boosts, and
/// hold for eight others (tests/benchmarks, Convergence of the steps).
class Limit {
  public:
    /// @param X   the input.
    /// @param E1  the shape that Y_1 is compared with.
    /// @param isInner  n, or empty: true; elsewhere the border of a tile causes errors of its own.
    Limit(const Vertices& X, Displacement E1, const LaplacianBuilder& laplacians,
          const std::vector<bool>& isInner)
        : X_(X), laplacians_(laplacians), isInner_(isInner), E1_(std::move(E1)) {}

    /// @param quarter  log areas around the vertices of F^(1/4)(sqrt(A)) X.
    void addFirst(Vertices Y, const Eigen::ArrayXd& quarter) {
        const Eigen::ArrayXd growth =
            logAreasAround(laplacians_.current().W, laplacians_.faces(), Y) - quarter;
        replace({}, std::move(Y), X_ + E1_.cast<double>());
        E1_.resize(0, 3);
        // The distance is an error of first order; that of second order is to it as the distance is
        // to the displacement, or more where areas shrink, since they do so ever faster. Where they
        // grow, they do so ever more slowly. What has gone in the first quarter is noise.
        constexpr double kMostOfGrowing = 0.1;
        const Eigen::ArrayXd moved = distances(Y_, X_).array();
        for (Index i = 0; i < errors_.size(); ++i) {
            const double most = growth[i] < 0.0 ? 1.0 : kMostOfGrowing,
                         change = errors_[i] * std::exp(std::max(0.0, -growth[i]));
            errors_[i] *= change < most * moved[i] ? change / moved[i] : most;
        }
        error_ = bound_ = largestOf(errors_);
    }

    /// @param isComparable  whether Y has twice the steps of the previous shape.
    void add(Vertices Y, int steps, bool isComparable) {
        const bool hasLike = isComparable && steps > 2;  // the first shape is by another rule
        Vertices E;
        if (hasLike) E = Y + (Y - Y_) / (kSecondOrder - 1.0);
        isExtrapolated_ = hasLike && steps >= kManySteps;
        // |E_K/2 - Y_K/4| = 4/3 |Y_K/2 - Y_K/4|.
        const double before = isExtrapolated_ && steps == kManySteps
                                  ? distance_ * kSecondOrder / (kSecondOrder - 1.0)
                                  : distance_;
        replace(std::move(E), std::move(Y), E_.rows() > 0 ? E_ : Y_);
        shrinking_ = distance_ > 0.0 ? before / distance_ : kSecondOrder;
        // Without extrapolation errors shrink no faster than those of second order, whatever the
        // first distances. The distance bounds the error where it does not shrink.
        constexpr double kUsualSecond = 0.25, kUsualLater = 0.8, kDecay = 0.4;
        const double rate = isExtrapolated_ ? shrinking_ : std::min(shrinking_, kSecondOrder);
        errors_ *= hasLike ? std::min(1.0, kUsualLater / std::pow(rate, kDecay)) : kUsualSecond;
        error_ = largestOf(errors_);
        // Estimates scatter, those of extrapolated shapes by a factor of two.
        constexpr double kSafety = 1.25, kSafetyOfExtrapolated = 1.5;
        bound_ = (isExtrapolated_ ? kSafetyOfExtrapolated : kSafety) * error_;
    }

    const Vertices& shape() const { return isExtrapolated_ ? E_ : Y_; }

    double error() const { return error_; }  ///< Estimated, without what collapses.
    double bound() const { return bound_; }  ///< What ends the passes.
    bool stagnates() const { return shrinking_ < kMinShrinking; }

    /// Fraction of the input surface where the estimated error exceeds the tolerance.
    double partBeyond(double tolerance) const {
        const Eigen::VectorXd& D = laplacians_.inputMass();
        double all = 0.0, beyond = 0.0;
        for (Index i = 0; i < D.size(); ++i) {
            if (!isInner(i)) continue;
            all += D[i];
            if (errors_[i] > tolerance) beyond += D[i];
        }
        return all > 0.0 ? beyond / all : 0.0;
    }

  private:
    /// @param E       empty if it is Y.
    /// @param before  the shape before it.
    void replace(Vertices E, Vertices Y, const Vertices& before) {
        const Vertices& shape = isExtrapolated_ ? E : Y;
        errors_ = distances(shape, before);
        isKept_ = laplacians_.mass(shape).array() >= kCollapsed * laplacians_.inputMass().array();
        for (Index i = 0; i < isKept_.size(); ++i) isKept_[i] = isKept_[i] && isInner(i);
        distance_ = largestOf(errors_);
        E_ = std::move(E);
        Y_ = std::move(Y);
    }

    double largestOf(const Eigen::VectorXd& lengths) const {
        return largestButNegligible(isKept_.select(lengths, 0.0), laplacians_.inputMass());
    }

    bool isInner(Index i) const { return isInner_.empty() || isInner_[i]; }

    const Vertices& X_;
    const LaplacianBuilder& laplacians_;
    const std::vector<bool>& isInner_;
    Displacement E1_;                               // until Y_1 is there
    Vertices Y_, E_;                                // E_ is extrapolated; empty if it is Y_
    Eigen::VectorXd errors_;                        // n, estimated, where parts collapse, too
    Eigen::Array<bool, Eigen::Dynamic, 1> isKept_;  // n, false where parts collapse
    double distance_ = 0.0, error_ = 0.0, bound_ = 0.0, shrinking_ = kSecondOrder;
    bool isExtrapolated_ = false;
};

/// Expected number of steps in the last pass.
int expectedLastPass(int K, double error, const AutomaticOptions& options) {
    if (options.passes > 0) return 1 << (options.passes - 1);
    int last = K;
    for (double left = error; left > options.tolerance && last < options.maxSteps;
         left /= kSecondOrder)
        last *= 2;
    return last;
}

/// The share of a pass of K steps in the work of itself and of all later passes. Unless there can
/// be no more, some of it is left for another one: more than is expected is not done at 100 %.
double shareOfPass(int K, int last, const AutomaticOptions& options) {
    constexpr double kChance = 0.25;
    const bool isCertain = options.passes > 0 || 2 * last > options.maxSteps;
    return K / (2.0 * last - K + (isCertain ? 0.0 : kChance * 2.0 * last));
}

}  // namespace

AutomaticSteps automaticSteps(LaplacianBuilder& laplacians, StepEvaluator& evaluate,
                              const Vertices& X, const AutomaticOptions& options,
                              const Progress& progress) {
    // The Laplacian of the input gives the paper's single step, the half step of the first pass and
    // a shape on the way to that of the second.
    constexpr double kFirst = 0.1;
    AutomaticSteps result;
    laplacians.reset();
    const auto predictFirst = [&](double from, double to, bool areOthersCompared) {
        Evaluation evaluation = evaluate.predict(laplacians.current(), X, {1.0, 0.5, 0.25},
                                                 progress.part(from, to), areOthersCompared);
        std::vector<Vertices> shapes;
        for (Eigen::MatrixXd& Y : evaluation.Y) {
            shapes.emplace_back(Y);
            Y.resize(0, 0);
        }
        return shapes;
    };
    std::vector<Vertices> first = predictFirst(0.0, 0.5 * kFirst, false);
    if (options.keepThinParts) {
        ThinParts parts = thinPartFactors(laplacians.current().W, laplacians.faces(), X, first[2],
                                          first[0], options.tile);
        result.thinPartFactor = parts.largest;
        if (parts.factors.size() > 0) {
            first.clear();  // before another three shapes are computed
            laplacians.scaleMass(std::move(parts.factors));
            first = predictFirst(0.5 * kFirst, kFirst, true);
        }
    }
    const std::vector<bool> whole;
    Limit limit(X, (first[0] - X).cast<float>(), laplacians,
                options.tile ? options.tile->inner : whole);
    const Eigen::ArrayXd quarterAreas =
        logAreasAround(laplacians.current().W, laplacians.faces(), first[2]);
    // Of the second pass, by interpolation.
    Displacement ahead = (0.75 * (first[2] - X) - 0.125 * (first[1] - X)).cast<float>();
    Vertices half = std::move(first[1]);
    first.clear();

    double done = kFirst;
    bool wasEven = true;
    for (int K = 1, last = expectedLastPass(1, 0.0, options);; K *= 2) {
        const double end = done + (1.0 - done) * shareOfPass(K, std::max(K, last), options);
        const Progress pass = progress.part(done, end);
        done = end;
        if (K == 1) {
            result.last = midpointSteps(laplacians, evaluate, X, K, kFinest, pass, std::move(half));
            limit.addFirst(std::move(result.last.X), quarterAreas);
        } else {
            if (K > 2) {  // a quarter step
                laplacians.reset();
                ahead = (evaluate.predict(laplacians.current(), X, {0.25 / K}, pass.part(0.0, 0.0))
                             .Y.front() -
                         X)
                            .cast<float>();
            }
            const auto run = [&](Vertices firstQuarter) {
                return midpointSteps(laplacians, evaluate, X, K, std::max(K, kFinest), pass, {},
                                     std::move(firstQuarter));
            };
            try {
                result.last = run(X + std::exchange(ahead, {}).cast<double>());
            } catch (const SolverFailure&) {
                // The whole shape changes so fast that shapes ahead mislead: it has collapsed.
                result.last = run({});
            }
        }
        // If one of two passes had to take smaller steps, both may have taken the same ones.
        const bool isEven = result.last.sizes.size() == static_cast<std::size_t>(K);
        const bool isComparable = std::exchange(wasEven, isEven) && isEven;
        if (K > 1) limit.add(std::move(result.last.X), K, isComparable);
        ++result.passes;
        const bool isReached = isComparable && limit.bound() <= options.tolerance;
        const bool stagnates = isComparable && K >= kManySteps && limit.stagnates();
        const bool isLast = options.passes > 0 ? result.passes == options.passes
                                               : isReached || stagnates || 2 * K > options.maxSteps;
        if (isLast) {
            result.last.X = limit.shape();
            result.error = limit.error();
            result.singularPart = limit.partBeyond(options.tolerance);
            return result;
        }
        last = expectedLastPass(2 * K, limit.bound() / kSecondOrder, options);
    }
}

}  // namespace spectral
