#pragma once

#include <vector>

namespace spectral {

/// Standard deviation of normally distributed values, from the median of their moduli; 0 if empty.
/// Up to half of the values may be outliers (median absolute deviation, Hampel 1974).
double medianDeviation(std::vector<double> moduli);

/// The same for values mixed with larger ones of another origin, as at creases: the median of the
/// moduli within three deviations, iterated.
double trimmedDeviation(std::vector<double> moduli);

/// The quantile of the moduli below which a given share lies, 0 <= share < 1; 0 if empty.
double quantile(std::vector<double> moduli, double share);

}  // namespace spectral
