#pragma once

#include <string>

#include "core/support/types.h"

namespace spectral {

/// A transfer function that a user has written.
struct CustomGain {
    Gain gain;  ///< F(omega), not yet checked: may be negative, or not finite. Evaluations
                ///< of one text are not for several threads at once.
    double cutoff = 0.0;  ///< omega_c, radians per length unit: as given, or the middle of points.
};

/// Lengths of a mesh that sizes may be relative to, length units.
struct MeshLengths {
    double diagonal = 0.0;  ///< Of the bounding box: `5%`.
    double meanEdge = 0.0;  ///< `6e`.
};

/// Reads a transfer function, in one of two notations.
///
/// Points of an Equalizer, `20%:1, 5%:2, 1%:0.1`: gains at feature sizes, which are percentages of
/// the diagonal, mean edges (`6e`) or lengths.
///
/// An expression of w = omega / omega_c, f = omega and l = lambda = omega^2 in the language of
/// muParser: `1/(1 + w^4)`, `w < 1 ? 1 : 0.5`.
///
/// @param cutoff  omega_c for expressions, radians per length unit, > 0.
/// @throws InvalidOption  that names the place of a mistake in the text.
CustomGain parseGain(const std::string& text, double cutoff, const MeshLengths& lengths);

}  // namespace spectral
