#pragma once

#include <vector>

namespace spectral {

/// Standard deviation of normally distributed values, from the median of their moduli; 0 for none.
/// Up to half of the values may be outliers (median absolute deviation, Hampel 1974).
double medianDeviation(std::vector<double> moduli);

/// The same where some of the values belong to something else and are larger, as at creases: the
/// median of the moduli within three deviations, repeated.
double trimmedDeviation(std::vector<double> moduli);

/// The value below which a share of the moduli lies, 0 <= share < 1; 0 for none.
double quantile(std::vector<double> moduli, double share);

}  // namespace spectral
