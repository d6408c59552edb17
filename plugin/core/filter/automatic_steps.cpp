#include "core/filter/automatic_steps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "core/filter/fractional_steps.h"
#include "core/mesh/mesh.h"
#include "core/support/thread_team.h"

namespace spectral {

namespace {

/// Shrinking of the distances from one pass to the next: of a second-order method, and the least
/// that is still taken for convergence when the error is estimated.
constexpr double kSecondOrder = 4.0, kSlowest = 1.25;

/// Fewer steps than this do not show that something has stopped converging. So many are taken for
/// parts that shrink away, too.
constexpr int kFewSteps = 8;

/// Length of the rows of A - B.
Eigen::VectorXd distances(const Vertices& A, const Vertices& B) {
    Eigen::VectorXd length(A.rows());
    parallelRows(A.rows(), [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) length[i] = (A.row(i) - B.row(i)).norm();
    });
    return length;
}

/// The least length that only kNegligibleArea of the masses D exceeds.
double largestButNegligible(const Eigen::VectorXd& length, const Eigen::VectorXd& D) {
    std::vector<int> order(static_cast<std::size_t>(length.size()));
    std::iota(order.begin(), order.end(), 0);
    double left = kNegligibleArea * D.sum();
    // Of the longest only, as many as are needed: halves of what is not yet sorted.
    auto end = order.end();
    for (auto begin = order.begin(); begin != end;) {
        const auto middle = begin + (end - begin + 1) / 2;
        const auto isLonger = [&](int i, int j) { return length[i] > length[j]; };
        std::nth_element(begin, middle - 1, end, isLonger);
        const double mass =
            std::accumulate(begin, middle, 0.0, [&](double sum, int i) { return sum + D[i]; });
        if (mass <= left) {
            left -= mass;
            begin = middle;
        } else if (middle - begin == 1) {
            return length[*begin];
        } else {
            end = middle;
        }
    }
    return 0.0;
}

/// How far shapes are apart from pass to pass, over a surface but kNegligibleArea of it, and how
/// these distances shrink.
class Convergence {
  public:
    /// @param D  masses of the surface, n.
    void add(const Eigen::VectorXd& distance, const Eigen::VectorXd& D) {
        const double before = std::exchange(distance_, largestButNegligible(distance, D));
        shrinking_ = std::isfinite(before) && distance_ > 0.0 ? before / distance_ : kUnknown;
    }

    /// What is still to come after a change, in parts of it: a geometric series.
    double toCome() const { return 1.0 / (std::clamp(shrinking_, kSlowest, kSecondOrder) - 1.0); }

    double error() const { return toCome() * distance_; }  ///< Estimated, of the last shape.
    bool stagnates() const { return shrinking_ < kSlowest; }

  private:
    /// Of two shapes there is no rate yet: that they come nearer by a half is little to ask.
    static constexpr double kUnknown = 2.0;

    double distance_ = std::numeric_limits<double>::infinity(), shrinking_ = kUnknown;
};

/// The limit of shapes Y_1, Y_2, Y_4, ..., by Richardson's extrapolation.
class Limit {
  public:
    /// @param E1  what Y_1 is compared with.
    Limit(Vertices E1, const LaplacianBuilder& laplacians)
        : laplacians_(laplacians), E_(std::move(E1)) {}

    void add(Vertices Y) {
        Vertices E = Y_.size() > 0 ? Vertices(Y + (Y - Y_) / (kSecondOrder - 1.0)) : Y;
        change_ = distances(E, E_);
        ofResult_.add(change_, laplacians_.mass(E));
        ofInput_.add(change_, laplacians_.inputMass());
        E_ = std::move(E);
        Y_ = std::move(Y);
    }

    const Vertices& last() const { return Y_; }
    const Vertices& extrapolated() const { return E_; }

    const Convergence& ofResult() const { return ofResult_; }  ///< Of extrapolated()'s surface.
    const Convergence& ofInput() const { return ofInput_; }

    /// Part of the input's surface where the estimated error exceeds the tolerance.
    double partBeyond(double tolerance) const {
        const Eigen::VectorXd& D = laplacians_.inputMass();
        return (ofInput_.toCome() * change_.array() > tolerance).select(D, 0.0).sum() / D.sum();
    }

  private:
    const LaplacianBuilder& laplacians_;
    Vertices Y_, E_;
    Eigen::VectorXd change_;  // n, how far the vertices are from E_K/2 to E_K
    Convergence ofResult_, ofInput_;
};

/// Number of steps of the pass that will probably be the last, after one with K steps.
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
    // From the Laplacian of the input: the paper's whole step, and the first half steps of the
    // first two passes.
    constexpr double kFirstPasses = 0.1;
    evaluate.setLaplacian(laplacians.input(), 0.5, progress.part(0.0, 0.5 * kFirstPasses));
    std::vector<Eigen::MatrixXd> first =
        evaluate.predict(X, {1.0, 0.5, 0.25}, progress.part(0.5 * kFirstPasses, kFirstPasses));
    const Vertices halves[] = {first[1], first[2]};
    Limit limit(first[0], laplacians);
    first.clear();

    AutomaticSteps result;
    double done = kFirstPasses;
    for (int K = 1, last = 2;; K *= 2) {
        // The passes from this one to the last take K + 2 K + ... + last steps.
        const double end = done + (1.0 - done) * K / (2.0 * std::max(K, last) - K);
        evaluate.forgetErrors();
        const Vertices* firstHalf = K <= 2 ? &halves[K - 1] : nullptr;
        FractionalSteps pass = midpointSteps(laplacians, evaluate, X, K, options.maxSteps,
                                             progress.part(done, end), firstHalf);
        done = end;
        limit.add(std::move(pass.X));
        result.sizes = std::move(pass.sizes);
        result.error = limit.ofResult().error();
        const bool isReached = result.error <= options.tolerance;
        // What shrinks away is worth a few passes only.
        const bool isEnough =
            isReached && (K >= kFewSteps || limit.ofInput().error() <= options.tolerance);
        const bool stagnates = K >= kFewSteps && limit.ofResult().stagnates();
        if (isEnough || stagnates || 2 * K > options.maxSteps) {
            result.X = isReached ? limit.extrapolated() : limit.last();
            result.singularPart = limit.partBeyond(options.tolerance);
            return result;
        }
        last = expectedLastPass(2 * K, result.error / kSecondOrder, options);
    }
}

}  // namespace spectral
