#include "core/graph/robust_statistics.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace spectral {

namespace {

/// The quantile `share` of the first `count` values, which are reordered; 0 if there are none.
double valueAt(std::vector<double>& values, std::ptrdiff_t count, double share) {
    if (count == 0) return 0.0;
    const auto at =
        values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(count));
    std::nth_element(values.begin(), at, values.begin() + count);
    return *at;
}

constexpr double kHalf = 0.5;
constexpr double kMedian = 0.6745;  // median modulus of the standard normal distribution

}  // namespace

double quantile(std::vector<double> moduli, double share) {
    return valueAt(moduli, static_cast<std::ptrdiff_t>(moduli.size()), share);
}

double medianDeviation(std::vector<double> moduli) {
    return quantile(std::move(moduli), kHalf) / kMedian;
}

double trimmedDeviation(std::vector<double> moduli) {
    constexpr double kTrimmedAt = 3.0, kMedianWithin = 0.6722;  // the same, of moduli below 3
    constexpr int kTrimmings = 5;
    auto count = static_cast<std::ptrdiff_t>(moduli.size());
    double deviation = valueAt(moduli, count, kHalf) / kMedian;
    for (int k = 0; k < kTrimmings; ++k) {
        const auto outliers = std::partition(moduli.begin(), moduli.end(), [&](double modulus) {
            return modulus < kTrimmedAt * deviation;
        });
        deviation = valueAt(moduli, outliers - moduli.begin(), kHalf) / kMedianWithin;
    }
    return deviation;
}

}  // namespace spectral
