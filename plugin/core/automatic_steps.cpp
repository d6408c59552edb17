#include "automatic_steps.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "fractional_steps.h"

namespace spectral {

namespace {

/// Shrinking of the differences from one pass to the next: of a second-order method, and the least
/// that is still taken for convergence when the error is estimated.
constexpr double kSecondOrder = 4.0, kSlowest = 1.25;

/// Differences that shrink less than this have stopped converging (a first-order method has it).
constexpr double kStagnant = 2.0;

/// Part of the result's area below which what has not converged is a pinched part.
constexpr double kPinchedArea = 1e-3;

/// Multiple of the tolerance that one more pass will probably bring within it.
constexpr double kNear = 2.0;

/// Fewer steps than this do not show that something has stopped converging.
constexpr int kFewSteps = 8;

/// Factor by which a change is smaller than the one before it.
double shrinking(double previous, double change) {
    return change > 0.0 ? std::clamp(previous / change, kSlowest, kSecondOrder) : kSecondOrder;
}

/// What is still to come after a change: a geometric series.
double remaining(double change, double shrinking) { return change / (shrinking - 1.0); }

/// The limit of shapes Y_1, Y_2, Y_4, ..., by Richardson's extrapolation.
class Limit {
  public:
    /// @param D  masses of Y's vertices.
    void add(Vertices Y, const Eigen::VectorXd& D) {
        if (Y_.size() > 0) {
            const Vertices difference = Y - Y_;
            Vertices E = Y + remaining(1.0, kSecondOrder) * difference;
            change_ = difference.rowwise().norm();
            const double largest = change_.maxCoeff();
            const double rms = std::sqrt(change_.cwiseAbs2().dot(D) / D.sum());
            largestShrinks_ = shrinking(largest_, largest);
            rmsShrinks_ = shrinking(rms_, rms);
            // The first change has no rate yet: E's error is a part of it if Y converges at all.
            error_ = E_.size() == 0
                         ? largest
                         : remaining((E - E_).rowwise().norm().maxCoeff(), largestShrinks_);
            largest_ = largest;
            rms_ = rms;
            E_ = std::move(E);
        }
        Y_ = std::move(Y);
    }

    const Vertices& last() const { return Y_; }
    const Vertices& extrapolated() const { return E_; }
    double error() const { return error_; }  ///< Estimated, of extrapolated(), at any vertex.
    bool stagnates() const { return largestShrinks_ < kStagnant; }

    /// Part of the mass D (n) on vertices of last() that are still to move by more than `tolerance`
    /// if all go on as the surface does on average.
    double unresolvedPart(const Eigen::VectorXd& D, double tolerance) const {
        const double toCome = remaining(1.0, rmsShrinks_);
        return (toCome * change_.array() > tolerance).select(D, 0.0).sum() / D.sum();
    }

  private:
    Vertices Y_, E_;
    Eigen::VectorXd change_;            // n, how far the vertices moved from Y_K/2 to Y_K
    double largest_ = 0.0, rms_ = 0.0;  // of change_
    double largestShrinks_ = 0.0, rmsShrinks_ = 0.0;
    double error_ = std::numeric_limits<double>::infinity();
};

/// Number of steps of the pass that will probably be the last, after one with K steps.
int expectedLastPass(int K, double error, const AutomaticOptions& options) {
    int last = 2 * K;
    if (std::isfinite(error))
        for (double left = error / kSecondOrder; left > options.tolerance; left /= kSecondOrder)
            last *= 2;
    return std::clamp(last, std::min(4, options.maxSteps), std::max(2 * K, options.maxSteps));
}

}  // namespace

AutomaticSteps automaticSteps(const LaplacianBuilder& laplacians, StepEvaluator& evaluate,
                              const Vertices& X, const AutomaticOptions& options,
                              const Progress& progress) {
    AutomaticSteps result;
    Limit limit;
    double done = 0.0;
    for (int K = 1, last = expectedLastPass(1, limit.error(), options);; K *= 2) {
        // The passes from this one to the last take K + 2 K + ... + last steps.
        const double end = done + (1.0 - done) * K / (2.0 * std::max(K, last) - K);
        evaluate.forgetErrors();
        FractionalSteps pass =
            midpointSteps(laplacians, evaluate, X, K, options.maxSteps, progress.part(done, end));
        done = end;
        const Eigen::VectorXd D = laplacians.mass(pass.X);
        limit.add(std::move(pass.X), D);
        result.sizes = std::move(pass.sizes);
        result.error = limit.error();
        if (result.error <= options.tolerance) {
            result.X = limit.extrapolated();
            return result;
        }
        const bool onlyPinchedPartsLeft = K >= kFewSteps && limit.stagnates() &&
                                          limit.unresolvedPart(D, options.tolerance) < kPinchedArea;
        const bool oneMorePass =
            2 * K <= options.maxSteps ||
            (K <= options.maxSteps && result.error <= kNear * options.tolerance);
        if (onlyPinchedPartsLeft || !oneMorePass) {
            result.X = limit.last();
            result.singularPart = limit.unresolvedPart(laplacians.input().D, options.tolerance);
            return result;
        }
        last = expectedLastPass(K, result.error, options);
    }
}

}  // namespace spectral
