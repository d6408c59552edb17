#include "core/krylov/full_spectrum.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "core/krylov/krylov_spaces.h"
#include "core/krylov/pole_selection.h"
#include "core/laplacian/constant_modes.h"
#include "core/laplacian/frequency.h"

namespace spectral {

namespace {

/// Dimensions from one check of the error to the next.
constexpr int kCheckInterval = 3;

/// Below this dimension a difference says nothing: a narrow band has not been seen yet.
constexpr int kFirstCheck = 6;

/// At this multiple of the requested accuracy over the surface the single vertices are looked at
/// too.
constexpr double kNearlyThere = 30.0;

/// Factor on the estimate where it stops short: at a cusp the changes shrink more slowly than any
/// geometric series, and add up to more.
constexpr double kStoppedShort = 3.0;

/// Estimates the error of the newest approximation from the changes between checks, in one norm.
///
/// With changes that shrink by a factor q from check to check, what is still to come is their
/// geometric series, change q / (1 - q). Where convergence is fast the last change itself is taken,
/// which is more; where it is slow the series is, which can be far more than the last change.
class ErrorEstimate {
  public:
    double operator()(double change) {
        changes_.push_back(change);
        constexpr std::size_t kMemory = 4;  // the rate is a mean over so many checks
        const std::size_t span = std::min(kMemory, changes_.size() - 1);
        if (span == 0) return std::numeric_limits<double>::infinity();
        if (change <= 0.0) return 0.0;
        const double ratio = change / changes_[changes_.size() - 1 - span];
        const double q = std::min(std::pow(ratio, 1.0 / static_cast<double>(span)), kSlowest);
        return change * std::max(1.0, q / (1.0 - q));
    }

  private:
    static constexpr double kSlowest = 0.9;  // changes that do not shrink at all are scatter
    std::vector<double> changes_;
};

/// The approximation of one gain's signals in growing spaces.
class Approximation {
  public:
    Approximation(const KrylovSpaces& spaces, const Gain& gain, double pole,
                  const FullSpectrumOptions& options)
        : spaces_(spaces),
          gain_(gain),
          options_(options),
          sufficient_(options.atEveryVertex ? std::nullopt
                                            : sufficientDimension(gain, pole, options.accuracy)),
          coefficients_(static_cast<std::size_t>(spaces.columns())),
          change_(coefficients_.size()) {}

    bool isSufficient(int dimension) const { return sufficient_ && dimension >= *sufficient_; }

    /// Renews the coefficients of all columns; returns the estimated error.
    double renew() {
        double squares = 0.0;
        for (int c = 0; c < spaces_.columns(); ++c) {
            change_[c] = spaces_.coefficients(c, gain_);
            coefficients_[c].conservativeResizeLike(Eigen::VectorXd::Zero(change_[c].size()));
            std::swap(coefficients_[c], change_[c]);
            change_[c] = coefficients_[c] - change_[c];
            squares += change_[c].squaredNorm();
        }
        const double error = overSurface_(std::sqrt(squares) / spaces_.norms().matrix().norm());
        if (!options_.atEveryVertex || error > kNearlyThere * options_.accuracy) return error;
        // A norm over the surface hardly sees a vertex of small mass; its error can be larger, and
        // shrink more slowly and less evenly: so the larger one of two changes counts.
        const double before = std::exchange(largest_, spaces_.largestEntryOf(change_));
        return std::max(error, atVertices_(std::max(before, largest_) / spaces_.largestEntry()));
    }

    Eigen::MatrixXd Y() const { return spaces_.combine(coefficients_); }

  private:
    const KrylovSpaces& spaces_;
    const Gain& gain_;
    const FullSpectrumOptions& options_;
    std::optional<int> sufficient_;
    std::vector<Eigen::VectorXd> coefficients_, change_;
    ErrorEstimate overSurface_, atVertices_;
    double largest_ = 0.0;
};

}  // namespace

FullSpectrumResult applyFullSpectrum(const Eigen::VectorXd& D, const ConstantModes& constants,
                                     const ShiftedCholesky& cholesky, const Gain& gain,
                                     const Eigen::MatrixXd& X, const FullSpectrumOptions& options,
                                     const Progress& progress) {
    return std::move(
        applyFullSpectrum(D, constants, cholesky, std::vector{gain}, X, options, progress).front());
}

std::vector<FullSpectrumResult> applyFullSpectrum(
    const Eigen::VectorXd& D, const ConstantModes& constants, const ShiftedCholesky& cholesky,
    const std::vector<Gain>& gains, const Eigen::MatrixXd& X, const FullSpectrumOptions& options,
    const Progress& progress) {
    KrylovSpaces spaces(cholesky, D, constants, X);
    if (!(spaces.largestEntry() > 0.0)) {
        FullSpectrumResult same;
        same.Y = X;
        same.converged = true;
        return std::vector<FullSpectrumResult>(gains.size(), same);
    }
    std::vector<FullSpectrumResult> results(gains.size());
    std::vector<Approximation> approximations;
    for (const Gain& gain : gains)
        approximations.emplace_back(spaces, gain, cholesky.shift(), options);

    const int first = std::max(kFirstCheck, std::min(options.resolution, options.maxDimension));
    double firstError = 0.0, furthest = 0.0;
    bool isDone = false;
    for (int m = 1; !isDone; ++m) {
        const bool isInvariant = !spaces.extend();
        bool isSufficient = m >= options.resolution;
        for (const Approximation& approximation : approximations)
            isSufficient = isSufficient && approximation.isSufficient(m);
        const bool isLast = m >= options.maxDimension;
        if (!isInvariant && !isSufficient && !isLast && m % kCheckInterval != 0) continue;

        isDone = isInvariant || isSufficient || isLast;
        bool allConverged = m >= first;
        double largestError = 0.0;
        for (std::size_t g = 0; g < gains.size(); ++g) {
            FullSpectrumResult& result = results[g];
            result.dimension = isInvariant ? m - 1 : m;
            result.errorEstimate = approximations[g].renew();
            // An invariant space leaves no error but round-off.
            if (isInvariant) result.errorEstimate = std::numeric_limits<double>::epsilon();
            if (isSufficient)
                result.errorEstimate = std::min(result.errorEstimate, options.accuracy);
            result.converged = result.errorEstimate <= options.accuracy;
            allConverged = allConverged && result.converged;
            largestError = std::max(largestError, result.errorEstimate);
        }
        isDone = isDone || allConverged;
        if (isDone || !std::isfinite(largestError)) continue;

        // Convergence is geometric: the logarithm of the error tells how far it is.
        if (firstError <= 0.0) firstError = std::max(largestError, options.accuracy * 10);
        const double done =
            std::log(firstError / largestError) / std::log(firstError / options.accuracy);
        furthest = std::clamp(done, furthest, 1.0);  // an estimate may be worse than the one before
        progress.report(furthest, "filtering");
    }

    const Eigen::MatrixXd means = constants.means(X);
    for (std::size_t g = 0; g < gains.size(); ++g) {
        FullSpectrumResult& result = results[g];
        if (!result.converged) result.errorEstimate *= kStoppedShort;
        result.Y = approximations[g].Y();
        constants.remove(result.Y);
        constants.add(means, result.Y);
    }
    return results;
}

}  // namespace spectral
