#include "full_spectrum.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "krylov_spaces.h"

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

}  // namespace

FullSpectrumResult applyFullSpectrum(const Eigen::VectorXd& D, const ConstantModes& constants,
                                     const ShiftedCholesky& cholesky, const Gain& gain,
                                     const Eigen::MatrixXd& X, const FullSpectrumOptions& options,
                                     const Progress& progress) {
    KrylovSpaces spaces(cholesky, D, constants, X);
    const double normX = spaces.norms().matrix().norm();
    FullSpectrumResult result;
    if (!(normX > 0.0)) {
        result.Y = X;
        result.converged = true;
        return result;
    }

    // Renews the coefficients of all columns, and Y once it is nearly there; returns the estimated
    // error of the signals.
    ErrorEstimate overSurface, atVertices;
    std::vector<Eigen::VectorXd> coefficients(X.cols()), change(X.cols());
    double largest = 0.0;
    const auto renew = [&] {
        double squares = 0.0;
        for (int c = 0; c < spaces.columns(); ++c) {
            change[c] = spaces.coefficients(c, gain);
            coefficients[c].conservativeResizeLike(Eigen::VectorXd::Zero(change[c].size()));
            std::swap(coefficients[c], change[c]);
            change[c] = coefficients[c] - change[c];
            squares += change[c].squaredNorm();
        }
        const double error = overSurface(std::sqrt(squares) / normX);
        if (error > kNearlyThere * options.accuracy) return error;
        // A norm over the surface hardly sees a vertex of small mass; its error can be larger, and
        // shrink more slowly and less evenly: so the larger one of two changes counts.
        const double before = largest;
        KrylovSpaces::Combination combination = spaces.combine(coefficients, change);
        result.Y = std::move(combination.Y);
        largest = combination.largestChange;
        return std::max(error, atVertices(std::max(before, largest) / spaces.largestEntry()));
    };

    double firstError = 0.0, furthest = 0.0;
    for (int m = 1;; ++m) {
        if (!spaces.extend()) {
            renew();  // the Krylov spaces are invariant: no error but round-off
            result.errorEstimate = std::numeric_limits<double>::epsilon();
            result.converged = true;
            break;
        }
        result.dimension = m;
        if (m % kCheckInterval != 0) continue;
        result.errorEstimate = renew();
        result.converged = m >= kFirstCheck && result.errorEstimate <= options.accuracy;
        if (result.converged) break;
        if (m >= options.maxDimension) {
            result.errorEstimate *= kStoppedShort;
            break;
        }

        // Convergence is geometric: the logarithm of the error tells how far it is.
        if (!std::isfinite(result.errorEstimate)) continue;
        if (firstError <= 0.0) firstError = std::max(result.errorEstimate, options.accuracy * 10);
        const double done =
            std::log(firstError / result.errorEstimate) / std::log(firstError / options.accuracy);
        furthest = std::clamp(done, furthest, 1.0);  // an estimate may be worse than the one before
        progress.report(furthest, "filtering");
    }

    result.Y = spaces.combine(coefficients, change).Y;
    constants.remove(result.Y);
    constants.add(constants.means(X), result.Y);
    return result;
}

}  // namespace spectral
