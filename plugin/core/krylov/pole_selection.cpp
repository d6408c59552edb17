#include "core/krylov/pole_selection.h"

#include <algorithm>
#include <cmath>
#include <vector>

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

/// Chebyshev series of a gain on an interval of theta.
class ChebyshevSeries {
  public:
    ChebyshevSeries(const Gain& gain, double pole, double first, double last, int nodes)
        : tail_(static_cast<std::size_t>(nodes) + 1, 0.0) {
        std::vector<double> cosine(4 * static_cast<std::size_t>(nodes));  // cos(pi i / (2 nodes))
        for (std::size_t i = 0; i < cosine.size(); ++i)
            cosine[i] = std::cos(kPi * static_cast<double>(i) / (2.0 * nodes));
        std::vector<double> value(static_cast<std::size_t>(nodes));
        for (int i = 0; i < nodes; ++i) {
            const double theta = first + (last - first) * 0.5 * (1.0 + cosine[2 * i + 1]);
            value[i] = gain(std::sqrt(std::max(0.0, pole / theta - pole)));
        }
        const auto [least, largest] = std::minmax_element(value.begin(), value.end());
        least_ = *least;
        largest_ = *largest;
        for (int degree = nodes - 1; degree >= 0; --degree) {
            double coefficient = 0.0;
            for (int i = 0; i < nodes; ++i)
                coefficient += value[i] * cosine[degree * (2 * i + 1) % (4 * nodes)];
            tail_[degree] = tail_[degree + 1] + std::abs(coefficient) * 2.0 / nodes;
        }
    }

    /// Number of leading coefficients needed for the accuracy.
    int requiredDimension(double accuracy) const {
        return static_cast<int>(std::partition_point(tail_.begin(), tail_.end(),
                                                     [&](double t) { return t > accuracy; }) -
                                tail_.begin());
    }

    /// Whether the values at the nodes come close to the extremes of the gain.
    bool reaches(const Extremes& extremes, double accuracy) const {
        const double margin = kExtremeTolerance * (largest_ - least_) + accuracy;
        return extremes.least >= least_ - margin && extremes.largest <= largest_ + margin;
    }

  private:
    std::vector<double>
        tail_;  // sums of |coefficients| from each degree on: truncation error bound
    double least_ = 0.0, largest_ = 0.0;
};

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
            const ChebyshevSeries series(gain, pole, pole / (range.highest + pole),
                                         pole / (range.lowest + pole), nodes);
            const int dimension = series.requiredDimension(target);
            if (dimension >= fewest || !series.reaches(extremes, accuracy)) continue;
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
