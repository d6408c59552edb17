#include "core/filter/automatic_steps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "core/filter/fractional_steps.h"
#include "core/mesh/mesh.h"
#include "core/support/threads.h"

namespace spectral {

namespace {

/// Factor by which distances shrink from one pass to the next with a second-order method.
constexpr double kSecondOrder = 4.0;

/// Smallest such factor that counts as convergence: below it, the sum of the geometric series would
/// exceed four times the last distance.
constexpr double kMinShrinking = 1.25;

/// A pass of this many steps that stagnates counts as singular: a second-order error would have
/// shrunk 64 times since the first pass.
constexpr int kSingularSteps = 8;

/// Failing steps are halved down to 1 / kFinest of the filter, however few steps a pass has.
constexpr int kFinest = 64;

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

/// Distance between the shapes of successive passes, over all but kNegligibleArea of the surface,
/// and the rate at which it shrinks.
class Convergence {
  public:
    /// @param D  masses of the surface, n.
    void add(const Eigen::VectorXd& distance, const Eigen::VectorXd& D) {
        const double before = std::exchange(distance_, largestButNegligible(distance, D));
        shrinking_ = std::isfinite(before) && distance_ > 0.0 ? before / distance_ : kUnknown;
        ++passes_;
    }

    /// Bound of the error of the last shape, which decides whether it is the last one: all later
    /// changes as a geometric series, at the rate of a second-order method at best.
    double bound() const {
        return distance_ / (std::clamp(shrinking_, kMinShrinking, kSecondOrder) - 1.0);
    }

    /// The error of the last shape relative to the last distance, as it usually is.
    double usual() const {
        if (passes_ == 1) return kUsualFirst;
        if (passes_ == 2) return kUsualSecond / std::max(shrinking_, kMinShrinking);
        if (stagnates()) return 1.0 / (kMinShrinking - 1.0);
        // Rates scatter: the next one is between the last one and that of the theory.
        return 1.0 / (std::sqrt(shrinking_ * kExtrapolated) - 1.0);
    }

    double error() const { return usual() * distance_; }  ///< Estimated error of the last shape.
    bool stagnates() const { return shrinking_ < kMinShrinking; }

  private:
    /// Assumed until three shapes give a rate: the error of a single step is then at most two
    /// thirds of its distance from the paper's step, about the worst case on real meshes.
    static constexpr double kUnknown = 2.5;

    /// The error of the midpoint rule's single step relative to its distance from the paper's,
    /// which is of first order: mostly 0.06 to 0.4 on real meshes.
    static constexpr double kUsualFirst = 0.15;

    /// The first distances are about the errors of methods of order 1 and 2. Their ratio is also
    /// about that of the latter to the error of E_2, which is of the next order.
    static constexpr double kUsualSecond = 0.6;

    /// Factor by which the errors of E_K shrink in theory, 8 if their order is 3 and 16 if it is 4:
    /// the geometric mean.
    static constexpr double kExtrapolated = 11.3;

    double distance_ = std::numeric_limits<double>::infinity(), shrinking_ = kUnknown;
    int passes_ = 0;
};

/// Limit of the shapes Y_1, Y_2, Y_4, ..., by Richardson extrapolation.
class Limit {
  public:
    /// @param E1  the shape that Y_1 is compared with.
    Limit(Vertices E1, const LaplacianBuilder& laplacians)
        : laplacians_(laplacians), E_(std::move(E1)) {}

    /// @param isComparable  whether Y has twice the steps of the previous shape.
    void add(Vertices Y, bool isComparable) {
        const bool isFirst = Y_.size() == 0;
        Vertices E = isFirst || !isComparable ? Y : Vertices(Y + (Y - Y_) / (kSecondOrder - 1.0));
        change_ = distances(E, E_);
        convergence_.add(change_, laplacians_.mass(E));
        E_ = std::move(E);
        Y_ = std::move(Y);
    }

    const Vertices& shape() const { return E_; }

    const Convergence& convergence() const { return convergence_; }  ///< Over the surface E_K.

    /// Fraction of the input surface where the estimated error exceeds the tolerance.
    double partBeyond(double tolerance) const {
        const Eigen::VectorXd& D = laplacians_.inputMass();
        return (convergence_.usual() * change_.array() > tolerance).select(D, 0.0).sum() / D.sum();
    }

  private:
    const LaplacianBuilder& laplacians_;
    Vertices Y_, E_;
    Eigen::VectorXd change_;  // n, displacements of the vertices from E_K/2 to E_K
    Convergence convergence_;
};

/// Estimated number of steps in the last pass.
int expectedLastPass(int K, double error, const AutomaticOptions& options) {
    int last = K;
    for (double left = error; left > options.tolerance && last < options.maxSteps;
         left /= kSecondOrder)
        last *= 2;
    return last;
}

}  // namespace

AutomaticSteps automaticSteps(LaplacianBuilder& laplacians, StepEvaluator& evaluate,
                              const Vertices& X, const AutomaticOptions& options,
                              const Progress& progress) {
    // The Laplacian of the input gives the paper's single step and the first half step of each of
    // the first two passes.
    constexpr double kFirstPasses = 0.1;
    AutomaticSteps result;
    laplacians.reset();
    const auto predictFirst = [&](double from, double to) {
        return evaluate.predict(laplacians.current(), X, {1.0, 0.5, 0.25}, progress.part(from, to))
            .Y;
    };
    std::vector<Eigen::MatrixXd> first = predictFirst(0.0, 0.5 * kFirstPasses);
    if (options.keepThinParts) {
        ThinParts parts = thinPartFactors(laplacians.current().W, laplacians.faces(), X, first[2],
                                          first[0], options.tile);
        result.thinPartFactor = parts.largest;
        if (parts.factors.size() > 0) {
            laplacians.scaleMass(std::move(parts.factors));
            first = predictFirst(0.5 * kFirstPasses, kFirstPasses);
        }
    }
    Vertices halves[] = {first[1], first[2]};
    Limit limit(first[0], laplacians);
    first.clear();

    double done = kFirstPasses;
    bool wasEven = true;
    for (int K = 1, last = 2;; K *= 2) {
        // This pass and all later ones take K + 2 K + ... + last steps.
        const double end = done + (1.0 - done) * K / (2.0 * std::max(K, last) - K);
        const Vertices* firstHalf = K <= 2 ? &halves[K - 1] : nullptr;
        result.last = midpointSteps(laplacians, evaluate, X, K, std::max(K, kFinest),
                                    progress.part(done, end), firstHalf);
        done = end;
        if (K <= 2) halves[K - 1].resize(0, 3);
        // If one of two passes had to take smaller steps, both may have taken the same ones.
        const bool isEven = result.last.sizes.size() == static_cast<std::size_t>(K);
        const bool isComparable = std::exchange(wasEven, isEven) && isEven;
        limit.add(std::move(result.last.X), isComparable);
        result.error = limit.convergence().error();
        ++result.passes;
        const double bound = limit.convergence().bound();
        const bool isReached = isComparable && bound <= options.tolerance;
        const bool stagnates =
            isComparable && K >= kSingularSteps && limit.convergence().stagnates();
        const bool isLast = options.passes > 0 ? result.passes == options.passes
                                               : isReached || stagnates || 2 * K > options.maxSteps;
        if (isLast) {
            result.last.X = limit.shape();
            result.singularPart = limit.partBeyond(options.tolerance);
            return result;
        }
        last = options.passes > 0 ? 1 << (options.passes - 1)
                                  : expectedLastPass(2 * K, bound / kSecondOrder, options);
    }
}

}  // namespace spectral
