#include "core/krylov/full_spectrum.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/krylov/krylov_spaces.h"
#include "core/krylov/series_evaluation.h"
#include "core/support/errors.h"

namespace spectral {

namespace {

/// Dimension of the next error check: checks get more expensive as the space grows.
/// @param fewest  smallest distance of checks.
int nextCheck(int m, int fewest) { return m + std::max(fewest, m / 10); }

/// Rows from which a solve takes far longer than a check.
constexpr Index kCostlySolve = 10000;

/// Multiple of the accuracy below which the error at the vertices is estimated as well. Each
/// estimate is a pass over the basis, wasted far from convergence, but its rate takes a few checks.
constexpr double kNearlyConverged = 30.0;

/// Relative round-off of solves beyond which results are useless.
constexpr double kUselessRoundOff = 0.03;

/// Frequencies at which gains are sampled, ascending: the given ones, and eighths of octaves on
/// both sides of the central frequency, up to the last.
Eigen::VectorXd sampleFrequencies(const KrylovOperator& S, std::vector<double> samples) {
    constexpr int kOctaves = 32, kPerOctave = 8;
    for (int i = -kOctaves * kPerOctave; i <= kOctaves * kPerOctave; ++i)
        samples.push_back(S.centralFrequency() * std::exp2(static_cast<double>(i) / kPerOctave));
    for (double& omega : samples) omega = std::min(omega, S.lastFrequency());
    std::sort(samples.begin(), samples.end());
    samples.erase(std::unique(samples.begin(), samples.end()), samples.end());
    return Eigen::Map<const Eigen::VectorXd>(samples.data(), static_cast<Index>(samples.size()));
}

/// Estimates the error of the newest approximation from the changes between checks.
///
/// If changes decay by a factor q per check, the remaining ones sum to change q / (1 - q). The
/// estimate is the larger of this, for slow convergence, and the last change, for fast.
class ErrorEstimate {
  public:
    double operator()(double change) {
        changes_.push_back(change);
        constexpr std::size_t kMemory = 4;  // checks over which the rate is averaged
        const std::size_t span = std::min(kMemory, changes_.size() - 1);
        if (span == 0) return std::numeric_limits<double>::infinity();
        if (change <= 0.0) return 0.0;
        const double ratio = change / changes_[changes_.size() - 1 - span];
        const double q = std::min(std::pow(ratio, 1.0 / static_cast<double>(span)), kSlowest);
        return change * std::max(1.0, q / (1.0 - q));
    }

  private:
    static constexpr double kSlowest = 0.9;  // larger rates are noise, and the sum diverges at 1
    std::vector<double> changes_;
};

/// Error of F(sqrt(A)) X, relative to X, caused by a relative error `roundOff` in applying S.
double roundOffError(const KrylovSpaces& spaces, double roundOff, const Gain& gain,
                     const KrylovOperator& S) {
    double squares = 0.0;
    for (int c = 0; c < spaces.columns(); ++c) {
        const auto [omega, weight] = spaces.quadrature(c);
        for (Index i = 0; i < omega.size(); ++i) {
            if (!std::isfinite(omega[i])) continue;
            const double theta = S.theta(omega[i] * omega[i]), error = S.errorOf(theta, roundOff);
            const double F = gain(omega[i]), above = gain(std::sqrt(S.lambda(theta + error))),
                         below = gain(std::sqrt(S.lambda(theta - error)));
            const double most = std::max(std::abs(above - F), std::abs(below - F));
            squares += weight[i] * most * most;
        }
    }
    return std::max(std::sqrt(squares) / spaces.norms().matrix().norm(), roundOff);
}

/// Successive approximations of F(sqrt(A)) X for one gain.
class Approximation {
  public:
    /// @param omega         frequencies at which the gain is sampled.
    /// @param smallestMass  smallest vertex mass.
    Approximation(const KrylovSpaces& spaces, const Gain& gain, const KrylovOperator& S,
                  const Eigen::VectorXd& omega, double smallestMass,
                  const FullSpectrumOptions& options)
        : spaces_(spaces),
          gain_(gain),
          S_(S),
          omega_(omega),
          gains_(omega.unaryExpr(gain)),
          options_(options),
          coefficients_(static_cast<std::size_t>(spaces.columns())),
          change_(coefficients_.size()),
          maxVertexRatio_(spaces.norms().matrix().norm() /
                          (std::sqrt(smallestMass) * spaces.largestEntry())) {}

    /// Updates the coefficients of all columns; returns the estimated error.
    double update() {
        double squares = 0.0;
        for (int c = 0; c < spaces_.columns(); ++c) {
            change_[c] = spaces_.coefficients(c, gain_);
            coefficients_[c].conservativeResizeLike(Eigen::VectorXd::Zero(change_[c].size()));
            std::swap(coefficients_[c], change_[c]);
            change_[c] = coefficients_[c] - change_[c];
            squares += spaces_.squaredErrorBound(c, coefficients_[c], omega_, gains_);
        }
        const double error = std::sqrt(squares) / spaces_.norms().matrix().norm();
        if (!options_.atEveryVertex || error > kNearlyConverged * options_.accuracy) return error;
        // Vertices of small mass hardly affect the norm over the surface. Their errors can be
        // larger, and decay more slowly and less evenly: the larger of two changes counts.
        const double before = std::exchange(largest_, spaces_.largestEntryOf(change_));
        double estimate = atVertices_(std::max(before, largest_) / spaces_.largestEntry());
        // Changes smaller than the error over the surface have missed the vertices that cause it.
        if (estimate < error) estimate = error * maxVertexRatio_;
        const double bound = std::max(error, mixingError()) * maxVertexRatio_;
        return std::max(error, std::min(estimate, bound));
    }

    /// The error caused by round-off in S; at every vertex if the options request that.
    double errorFromRoundOff(double roundOff) const {
        const double error = roundOffError(spaces_, roundOff, gain_, S_);
        if (!options_.atEveryVertex) return error;
        const double bound = error * maxVertexRatio_;
        if (!options_.roundOffAtVertices) return bound;
        const double measured = roundOffError(spaces_, *options_.roundOffAtVertices, gain_, S_);
        return std::min(std::max(measured, error), bound);
    }

    const std::vector<Eigen::VectorXd>& coefficients() const { return coefficients_; }

  private:
    /// Error of F(sqrt(A)) X, relative to X, where round-off in S mixes eigenvectors: to first
    /// order, the divided differences of F as a function of theta, times the round-off.
    double mixingError() const {
        constexpr double kRoundOff = 1e-15;  // relative, in each theta
        const Eigen::ArrayXd theta =
            omega_.array().unaryExpr([&](double omega) { return S_.theta(omega * omega); });
        double squares = 0.0;
        for (int c = 0; c < spaces_.columns(); ++c) {
            const auto [omega, weight] = spaces_.quadrature(c);
            for (Index i = 0; i < omega.size(); ++i) {
                const double ritz = S_.theta(omega[i] * omega[i]);
                const double error = S_.errorOf(ritz, kRoundOff);
                const Eigen::ArrayXd distance = (theta - ritz).abs() + error;
                const double most =
                    ((gains_.array() - gain_(omega[i])).abs() / distance).maxCoeff() * error;
                squares += weight[i] * most * most;
            }
        }
        return std::sqrt(squares) / spaces_.norms().matrix().norm();
    }

    const KrylovSpaces& spaces_;
    const Gain& gain_;
    const KrylovOperator& S_;
    const Eigen::VectorXd& omega_;
    Eigen::VectorXd gains_;
    const FullSpectrumOptions& options_;
    std::vector<Eigen::VectorXd> coefficients_, change_;
    double maxVertexRatio_;  // bound of the error at a vertex over the error over the surface
    ErrorEstimate atVertices_;
    double largest_ = 0.0;
};

/// applyFullSpectrum for more than `most` signals, in blocks.
std::vector<FullSpectrumResult> applyInBlocks(const Laplacian& laplacian, const KrylovOperator& S,
                                              const std::vector<Gain>& gains, const Signals& X,
                                              const FullSpectrumOptions& options, Index most,
                                              const Progress& progress) {
    std::vector<FullSpectrumResult> results(gains.size(), {X, 0.0, 0, true});
    const auto all = static_cast<double>(X.cols());
    for (Index first = 0; first < X.cols(); first += most) {
        const Index count = std::min(most, X.cols() - first), end = first + count;
        const std::vector<FullSpectrumResult> block = applyFullSpectrum(
            laplacian, S, gains, X.middleCols(first, count), options,
            progress.part(static_cast<double>(first) / all, static_cast<double>(end) / all));
        if (block.empty()) return {};
        for (std::size_t g = 0; g < gains.size(); ++g) {
            results[g].Y.middleCols(first, count) = block[g].Y;
            results[g].errorEstimate = std::max(results[g].errorEstimate, block[g].errorEstimate);
            results[g].dimension = std::max(results[g].dimension, block[g].dimension);
            results[g].converged = results[g].converged && block[g].converged;
        }
    }
    return results;
}

}  // namespace

std::vector<FullSpectrumResult> applyFullSpectrum(const Laplacian& laplacian,
                                                  const KrylovOperator& S,
                                                  const std::vector<Gain>& gains, const Signals& X,
                                                  const FullSpectrumOptions& options,
                                                  const Progress& progress) {
    const auto inBlocks = [&](Index most) {
        return applyInBlocks(laplacian, S, gains, X, options, most, progress);
    };
    if (X.cols() > kMaxSignalsOfSeries) return inBlocks(kMaxSignalsOfSeries);
    const Eigen::VectorXd& D = laplacian.D;
    const ConstantModes& constants = laplacian.constants;
    const Eigen::VectorXd omega = sampleFrequencies(S, options.samples);
    auto series = applySeries(laplacian, S, gains, X, omega, options, progress);
    if (!series.empty() || S.isProduct()) return series;
    if (X.cols() > kMaxSignals) return inBlocks(kMaxSignals);
    double orthogonal = KrylovSpaces::kOrthogonal;
    if (options.atEveryVertex)  // at vertices of small mass, basis vectors have large entries
        orthogonal = std::min(orthogonal, options.accuracy * std::sqrt(D.minCoeff() / D.sum()));
    KrylovSpaces spaces(S, laplacian, X, orthogonal);
    if (!(spaces.largestEntry() > 0.0)) return {gains.size(), {X, 0.0, 0, true}};
    std::vector<FullSpectrumResult> results(gains.size());
    std::vector<Approximation> approximations;
    for (const Gain& gain : gains)
        approximations.emplace_back(spaces, gain, S, omega, D.minCoeff(), options);

    // Even a space of full dimension may not be invariant: where eigenvalues span many decades, its
    // last vectors are round-off.
    const Index largest = std::min<Index>(options.maxDimension, D.size() - constants.count());
    // At the vertices, the rate of decay takes changes over several dimensions.
    const bool areSolvesCostly = !options.atEveryVertex && D.size() >= kCostlySolve;
    double firstError = 0.0, furthest = 0.0, roundOff = options.roundOff;
    bool isDone = false;
    for (int m = 1, check = 3; !isDone; ++m) {
        progress.report(furthest, "filtering");
        const bool isInvariant = !spaces.extend();
        const bool isLast = m >= largest;
        if (!isInvariant && !isLast && m < check) continue;
        check = nextCheck(m, areSolvesCostly ? 1 : 3);
        roundOff = std::max(roundOff, spaces.roundOff());
        if (roundOff > kUselessRoundOff)
            throw SolverFailure(ErrorCode::SingularMatrix,
                                "the solutions with W + s D are lost in round-off: the mesh has "
                                "needle triangles, or parts that are far apart");

        bool allConverged = true;
        double largestError = 0.0;
        for (std::size_t g = 0; g < gains.size(); ++g) {
            FullSpectrumResult& result = results[g];
            result.dimension = isInvariant ? m - 1 : m;
            result.errorEstimate = approximations[g].update();
            result.converged = result.errorEstimate <= options.accuracy;
            allConverged = allConverged && result.converged;
            largestError = std::max(largestError, result.errorEstimate);
        }
        isDone = isInvariant || isLast || allConverged;
        if (isDone || !std::isfinite(largestError)) continue;

        // Convergence is geometric: progress is linear in the logarithm of the error.
        if (firstError <= 0.0) firstError = std::max(largestError, options.accuracy * 10);
        const double done =
            std::log(firstError / largestError) / std::log(firstError / options.accuracy);
        furthest = std::clamp(done, furthest, 1.0);  // the estimate may increase
    }

    const Eigen::MatrixXd means = constants.means(D, X);
    for (std::size_t g = 0; g < gains.size(); ++g) {
        FullSpectrumResult& result = results[g];
        // In an invariant space, round-off is the only error.
        result.errorEstimate =
            std::max(result.errorEstimate, approximations[g].errorFromRoundOff(roundOff));
        result.converged = result.errorEstimate <= options.accuracy;
        if (!result.converged) result.errorEstimate *= kNotConverged;
    }
    // Kovnatsky et al. 2012, Eq. 6: Y = Phi F(Lambda^1/2) Phi^T D X, except for the constants.
    std::vector<std::vector<Eigen::VectorXd>> coefficients;
    for (const Approximation& approximation : approximations)
        coefficients.push_back(approximation.coefficients());
    std::vector<Eigen::MatrixXd> Y = spaces.combineAll(coefficients);
    for (std::size_t g = 0; g < gains.size(); ++g) {
        FullSpectrumResult& result = results[g];
        result.Y = std::move(Y[g]);
        constants.remove(D, result.Y);
        constants.add(means, result.Y);
    }
    return results;
}

double roundOffAtVertices(const ShiftedLdlt& ldlt, const Laplacian& laplacian) {
    const Eigen::VectorXd ones = Eigen::VectorXd::Ones(laplacian.D.size());
    const double pole = -ldlt.shift();
    return (ldlt.solve(laplacian.W * ones + pole * laplacian.D) - ones).lpNorm<Eigen::Infinity>();
}

}  // namespace spectral
