#pragma once

#include <string>
#include <vector>

#include "core/contract/value.h"
#include "core/mesh/measures.h"

namespace spectral {

/// What every host shows and checks about one parameter of a filter.
struct Parameter {
    enum class Kind { Bool, Integer, Number, Length, Choice, Text };

    std::string name;   ///< In scripts and commands: unique in its filter, must never change.
    std::string label;  ///< In dialogs.
    std::string help;  ///< Plain text, without the range; *word* stands out, |word| is a parameter.
    std::string unit{};   ///< Of a number, and its range: "octaves, above 0".
    std::string range{};  ///< Of a number, in words: "above 0".
    Kind kind = Kind::Number;
    Value usual = 0.0;  ///< The default; of a length a text (length.h).
    bool isAdvanced = false;
    double low = 0.0, high = 0.0;  ///< Range; unbounded above unless high > low.
    bool isLowOpen = false;
    std::vector<std::string> choices{};  ///< In the order of the enumeration.

    /// Of a length: the default for a mesh, and in words. Null: the default is 0.
    double (*automatic)(const MeshLengths& mesh) = nullptr;
    std::string automaticText{};
    double largestShare = 1.0;  ///< Of a length: how much of the diagonal it may be.
};

/// The range of a number in words: "0 to 180", "at least 0".
std::string rangeOf(const Parameter& parameter);

/// Checks a value and converts it to the type of a parameter: a choice to its number, a length to
/// length units.
/// @throws InvalidOption  when the type is wrong, there is no such choice, a number is out of
/// range, or a length is out of all proportion to the mesh, such as 2 where 2% was meant; names the
/// parameter.
Value converted(const Parameter& parameter, const Value& value, const MeshLengths& mesh);

/// Checks a value without a mesh: a choice becomes its name, a length what Length::parse takes.
/// @throws InvalidOption  as converted, but for proportions.
Value checked(const Parameter& parameter, const Value& value);

/// @throws InvalidOption  that names a value of `given` for which there is no parameter.
[[noreturn]] void rejectUnknown(const std::vector<Parameter>& parameters, const Values& given);

/// The default of a length for a mesh, length units.
double automaticLength(const Parameter& parameter, const MeshLengths& mesh);

}  // namespace spectral
