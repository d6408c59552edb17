#pragma once

#include <Eigen/Core>

#include "core/contract/value.h"
#include "core/mesh/measures.h"

namespace spectral {

/// The gains that Spectral Filter (Fractional) applies, for figures.
///
/// @param given        values of its parameters, but for the feature size.
/// @param featureSize  length units, > 0.
/// @param mesh         what sizes of a custom transfer function refer to.
/// @param w            relative frequencies, feature size / wavelength, >= 0.
/// @return  one gain for each. Filters keep the constant mode, whatever the gain at 0.
/// @throws InvalidOption
Eigen::VectorXd gainsAt(const Values& given, double featureSize, const MeshLengths& mesh,
                        const Eigen::VectorXd& w);

}  // namespace spectral
