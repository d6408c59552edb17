#include "pole_selection.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace spectral {

namespace {

/// Chebyshev nodes: degrees up to this are told apart, more than any Krylov space should need.
constexpr int kNodes = 256;

/// Poles that are tried: powers of two times the cutoff's lambda.
constexpr int kLowestPower = -6, kHighestPower = 12;

/// cos(pi i / (2 kNodes)) for all i of one period.
std::vector<double> cosineTable() {
    std::vector<double> table(4 * kNodes);
    for (std::size_t i = 0; i < table.size(); ++i)
        table[i] = std::cos(kPi * static_cast<double>(i) / (2.0 * kNodes));
    return table;
}

/// Moduli of the Chebyshev coefficients of the gain as a function of theta = pole / (lambda +
/// pole), summed from the highest degree down: entry d bounds the error of the best polynomial of
/// degree below d.
std::vector<double> chebyshevTails(const Gain& gain, double pole, const SpectrumRange& range,
                                   const std::vector<double>& cosine) {
    const double first = pole / (range.highest + pole), last = pole / (range.lowest + pole);
    std::vector<double> value(kNodes);
    for (int i = 0; i < kNodes; ++i) {
        const double theta = first + (last - first) * 0.5 * (1.0 + cosine[2 * i + 1]);
        value[i] = gain(std::sqrt(std::max(0.0, pole / theta - pole)));
    }
    std::vector<double> tail(kNodes + 1, 0.0);
    for (int degree = kNodes - 1; degree >= 0; --degree) {
        double coefficient = 0.0;
        for (int i = 0; i < kNodes; ++i)
            coefficient += value[i] * cosine[degree * (2 * i + 1) % (4 * kNodes)];
        tail[degree] = tail[degree + 1] + std::abs(coefficient) * 2.0 / kNodes;
    }
    return tail;
}

/// Degree from which on the tail stays below the accuracy.
Index requiredDegree(const std::vector<double>& tail, double accuracy) {
    return std::partition_point(tail.begin(), tail.end(), [&](double t) { return t > accuracy; }) -
           tail.begin();
}

}  // namespace

double selectPole(const Gain& gain, double cutoff, const SpectrumRange& range, double accuracy) {
    const std::vector<double> cosine = cosineTable();
    std::vector<double> poles;
    std::vector<std::vector<double>> tails;
    for (int power = kLowestPower; power <= kHighestPower; ++power) {
        poles.push_back(std::exp2(power) * cutoff * cutoff);
        tails.push_back(chebyshevTails(gain, poles.back(), range, cosine));
    }
    // Aliasing spoils the upper half of the coefficients of a gain that is not resolved: such a
    // gain is judged at the finest accuracy that some pole does reach.
    for (double target = accuracy;; target *= 10.0) {
        std::size_t best = 0;
        for (std::size_t p = 1; p < poles.size(); ++p)
            if (requiredDegree(tails[p], target) < requiredDegree(tails[best], target)) best = p;
        if (requiredDegree(tails[best], target) <= kNodes / 2) return poles[best];
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
