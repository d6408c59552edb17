#pragma once

#include <functional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/contract/parameter.h"
#include "core/contract/warning.h"

namespace spectral {

/// A parameter that stands for a member of `Call`, the arguments of a filter.
///
/// Its type is that of the member, its default the member's own: both stand once, in the struct.
template <class Call>
struct Field : Parameter {
    std::function<Value(const Call&)> get;
    std::function<void(Call&, const Value&)> set;  ///< Of a converted value.
    /// Null if the parameter has an effect, else when it has none: "without |steps = 0|".
    const char* (*unused)(const Call&) = nullptr;

    Field&& advanced() && {
        isAdvanced = true;
        return std::move(*this);
    }
    /// @param words  the range, if it is not one of numbers.
    Field&& in(std::string itsUnit, std::string words = {}) && {
        unit = std::move(itsUnit);
        range = std::move(words);
        return std::move(*this);
    }
    Field&& from(double least) && {
        low = least;
        return std::move(*this);
    }
    Field&& above(double bound) && {
        low = bound;
        isLowOpen = true;
        return std::move(*this);
    }
    Field&& to(double most) && {
        high = most;
        return std::move(*this);
    }
    Field&& of(std::vector<std::string> names) && {
        choices = std::move(names);
        return std::move(*this);
    }
    Field&& unusedIf(const char* (*when)(const Call&)) && {
        unused = when;
        return std::move(*this);
    }
    /// Makes a number a length. @param text  its default, in words a user may write.
    Field&& length(const char* text, double (*ofMesh)(const MeshLengths&), std::string inWords) && {
        kind = Kind::Length;
        usual = std::string(text);
        automatic = ofMesh;
        automaticText = std::move(inWords);
        return std::move(*this);
    }
    /// Bounds a length by a share of the diagonal.
    Field&& upToShare(double most) && {
        largestShare = most;
        return std::move(*this);
    }
};

template <class Call>
using Fields = std::vector<Field<Call>>;

/// @param at  the member, `&Call::member`, or where it is: `[](auto& call) -> auto& { ... }`.
template <class Call, class At>
Field<Call> field(At at, const char* name, const char* label, const char* help) {
    using T = std::remove_reference_t<std::invoke_result_t<At, Call&>>;
    Field<Call> made;
    made.name = name;
    made.label = label;
    made.help = help;
    made.kind = std::is_same_v<T, bool>          ? Parameter::Kind::Bool
                : std::is_same_v<T, int>         ? Parameter::Kind::Integer
                : std::is_same_v<T, std::string> ? Parameter::Kind::Text
                : std::is_enum_v<T>              ? Parameter::Kind::Choice
                                                 : Parameter::Kind::Number;
    if constexpr (std::is_enum_v<T>) {
        made.get = [at](const Call& call) -> Value {
            return static_cast<int>(std::invoke(at, call));
        };
        made.set = [at](Call& call, const Value& value) {
            std::invoke(at, call) = static_cast<T>(std::get<int>(value));
        };
    } else {
        made.get = [at](const Call& call) -> Value { return std::invoke(at, call); };
        made.set = [at](Call& call, const Value& value) {
            std::invoke(at, call) = std::get<T>(value);
        };
    }
    const Call defaults;
    made.usual = made.get(defaults);
    return made;
}

template <class Call>
std::vector<Parameter> parametersOf(const Fields<Call>& fields) {
    std::vector<Parameter> parameters(fields.begin(), fields.end());
    for (Parameter& one : parameters) {
        if (one.unit.empty()) continue;
        if (one.range.empty()) one.range = rangeOf(one);
        one.unit += ", " + one.range;
    }
    return parameters;
}

/// The arguments of a filter, with defaults for what is not given.
/// @throws InvalidOption  when a value is of the wrong type, or there is no such choice or
/// parameter.
template <class Call>
Call callOf(const Fields<Call>& fields, const Values& given, const MeshLengths& mesh) {
    Call call;
    std::size_t known = 0;
    for (const Field<Call>& one : fields) {
        const auto found = given.find(one.name);
        if (found != given.end()) ++known;
        const Value& value = found != given.end() ? found->second : one.usual;
        one.set(call, converted(one, value, mesh));
    }
    if (known < given.size()) rejectUnknown(parametersOf(fields), given);
    return call;
}

/// Warnings about parameters that are not at their defaults but have no effect with the others:
/// "order has no effect without response = butterworth".
template <class Call>
Warnings unusedWarnings(const Fields<Call>& fields, const Call& call) {
    Warnings warnings;
    for (const Field<Call>& one : fields) {
        if (one.unused == nullptr || one.get(call) == converted(one, one.usual, {})) continue;
        if (const char* const when = one.unused(call))
            warnings.push_back(
                {WarningCode::UnusedOption, "|" + one.name + "| has no effect " + when});
    }
    return warnings;
}

}  // namespace spectral
