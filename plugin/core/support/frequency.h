#pragma once

#include <cmath>

#include "core/support/errors.h"
#include "core/support/types.h"

namespace spectral {

/// The cutoff frequency omega_c = 2 pi / featureSize, radians per length unit.
///
/// @param featureSize  wavelength at the cutoff, length units, > 0.
/// @throws InvalidOption  when it is not finite or not above zero.
inline double cutoffFrequency(double featureSize) {
    if (!std::isfinite(featureSize) || featureSize <= 0.0)
        throw InvalidOption("feature_size = " + textOf(featureSize) +
                            ": must be a length above zero, e.g. 5 % of the bounding box diagonal");
    return 2.0 * kPi / featureSize;
}

}  // namespace spectral
