#pragma once

#include <string>

#include "core/mesh/measures.h"

namespace spectral {

/// What a length may be given as.
inline constexpr const char* kLengthForms =
    "a percentage of the bounding box diagonal such as 5%, mean edges such as 6e, or a length such "
    "as 0.02";

/// A length as users write it: `5%` of the diagonal, `6e` (mean edges), `0.02` length units, or
/// `auto`, chosen to suit the mesh.
struct Length {
    enum class Unit { Absolute, Percent, Edges, Automatic };

    double value = 0.0;
    Unit unit = Unit::Automatic;

    /// @throws InvalidOption  when the text is none of these, or a percentage is above 100.
    static Length parse(const std::string& text);

    /// In length units, in single precision, in which pymeshlab passes lengths on: a size then
    /// is bit-for-bit the same in all hosts.
    /// @param automatic  what `auto` stands for.
    double in(const MeshLengths& mesh, double automatic) const;
};

/// What a number is to be, ", at most 3.4e+38" or the least, where it is infinite or zero in single
/// precision; else nothing.
std::string limitOfSinglePrecision(double number);

/// The number in single precision, unless that would be zero or infinite.
double inSinglePrecision(double number);

}  // namespace spectral
