#pragma once

#include <string>

#include "core/mesh/measures.h"
#include "core/support/types.h"

namespace spectral {

/// A transfer function written by the user.
struct CustomGain {
    Gain gain;            ///< F(omega), unchecked: may be negative or not finite. Not thread-safe:
                          ///< copies share their state.
    double cutoff = 0.0;  ///< omega_c, radians per length unit: as given, or the middle of points.
};

/// Parses a transfer function in one of two notations.
///
/// Points of an Equalizer, `20%:1, 5%:2, 1%:0.1`: gains at feature sizes, which are percentages of
/// the diagonal, mean edges (`6e`) or lengths.
///
/// An expression of w = omega / omega_c, f = omega and l = lambda = omega^2 in the language of
/// muParser: `1/(1 + w^4)`, `w < 1 ? 1 : 0.5`.
///
/// @param cutoff   omega_c for expressions, radians per length unit, > 0.
/// @param lengths  of the mesh that percentages and mean edges refer to.
/// @throws InvalidOption  when the text is wrong; the message says at which character.
CustomGain parseGain(const std::string& text, double cutoff, const MeshLengths& lengths);

}  // namespace spectral
