#include "core/krylov/pole_selection.h"

#include <algorithm>
#include <cmath>

#include "core/krylov/chebyshev_series.h"

namespace spectral {

namespace {

/// Number of Chebyshev nodes: n nodes resolve degrees up to n / 2; doubled only where needed.
constexpr int kMinNodes = 32, kMaxNodes = 256;

/// Candidate poles, powers of two times omega_c^2: a wide range, as a trial costs no solve.
constexpr int kLowestPower = -6, kHighestPower = 12;

/// Fraction of the range of a gain by which the nodes may miss its peak or notch.
constexpr double kExtremeTolerance = 0.25;

/// Largest factor by which a pole may lie outside the range of eigenvalues.
constexpr double kMaxOutside = 64.0;

/// Smallest and largest values of a gain.
struct Extremes {
    double least, largest;
};

/// Extremes over a range, sampled at eighths of octaves around the cutoff and at both ends.
Extremes extremesOf(const Gain& gain, double cutoff, const SpectrumRange& range) {
    constexpr double kPerOctave = 8.0;
    const double first = std::sqrt(range.lowest), last = std::sqrt(range.highest);
    auto [least, largest] = std::minmax({gain(first), gain(last)});
    const double begin = std::ceil(kPerOctave * std::log2(first / cutoff));
    for (double i = begin; cutoff * std::exp2(i / kPerOctave) < last; ++i) {
        const double value = gain(cutoff * std::exp2(i / kPerOctave));
        least = std::min(least, value);
        largest = std::max(largest, value);
    }
    return {least, largest};
}

/// Whether the values at the nodes of a series come close to the extremes of the gain.
bool reaches(const ChebyshevSeries& series, const Extremes& extremes, double accuracy) {
    const double margin = kExtremeTolerance * (series.largest() - series.least()) + accuracy;
    return extremes.least >= series.least() - margin &&
           extremes.largest <= series.largest() + margin;
}

}  // namespace

double selectPole(const Gain& gain, double cutoff, const SpectrumRange& range, double accuracy) {
    const double atCutoff =
        std::clamp(cutoff * cutoff, range.lowest / kMaxOutside, range.highest * kMaxOutside);
    const Extremes extremes = extremesOf(gain, cutoff, range);
    double best = atCutoff;
    int nodes = kMinNodes;
    for (double target = accuracy;;) {
        int fewest = nodes + 1;
        for (int power = kLowestPower; power <= kHighestPower; ++power) {
            const double pole = std::min(std::exp2(power) * atCutoff, range.highest * kMaxOutside);
            const ChebyshevSeries series(
                [&](double theta) { return gain(std::sqrt(std::max(0.0, pole / theta - pole))); },
                pole / (range.highest + pole), pole / (range.lowest + pole), nodes);
            const int dimension = series.lengthFor(target);
            if (dimension >= fewest || !reaches(series, extremes, accuracy)) continue;
            fewest = dimension;
            best = pole;
        }
        // If a gain is not resolved, aliasing makes the upper half of the coefficients meaningless.
        // With the maximum number of nodes, the best accuracy reached by any pole decides instead.
        if (fewest <= nodes / 2) return best;
        if (nodes < kMaxNodes)
            nodes *= 2;
        else if (fewest > nodes)
            return atCutoff;  // every series has missed something
        else
            target *= 10.0;
    }
}

SpectrumRange bulkSpectrum(const Laplacian& laplacian) {
    Eigen::VectorXd local = 2.0 * laplacian.W.diagonal().cwiseQuotient(laplacian.D);
    const Index percentile = std::min<Index>(local.size() - 1, local.size() * 99 / 100);
    std::nth_element(local.data(), local.data() + percentile, local.data() + local.size());
    const double first = 0.1 * 4.0 * kPi / laplacian.D.sum();
    return {first, std::max(local[percentile], 2.0 * first)};
}

}  // namespace spectral
