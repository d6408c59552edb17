#include "values.h"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <string>
#include <utility>

#include "arrays.h"
#include "core/contract/presets.h"
#include "core/support/errors.h"

namespace spectral::python {

namespace {

Value valueOf(const std::string& name, nb::handle given) {
    if (nb::isinstance<nb::bool_>(given)) return nb::cast<bool>(given);
    if (nb::isinstance<nb::str>(given)) return nb::cast<std::string>(given);
    if (int integer = 0; nb::isinstance<nb::int_>(given) && nb::try_cast(given, integer))
        return integer;
    if (double number = 0.0; nb::try_cast(given, number)) return number;
    throw InvalidOption(name + " = " + nb::cast<std::string>(nb::str(given)) +
                        ": must be a number, a text, true or false");
}

nb::object objectOf(Value&& value) {
    return std::visit(
        [](auto&& one) -> nb::object {
            using T = std::decay_t<decltype(one)>;
            if constexpr (std::is_same_v<T, Eigen::VectorXd>)
                return python::given(std::move(one));
            else
                return nb::cast(one);
        },
        std::move(value));
}

const char* nameOf(Parameter::Kind kind) {
    switch (kind) {
        case Parameter::Kind::Bool: return "bool";
        case Parameter::Kind::Integer: return "int";
        case Parameter::Kind::Number: return "float";
        case Parameter::Kind::Length: return "length";
        case Parameter::Kind::Choice: return "choice";
        case Parameter::Kind::Text: break;
    }
    return "str";
}

nb::dict described(const Parameter& parameter) {
    nb::dict result;
    result["name"] = parameter.name;
    result["label"] = parameter.label;
    result["help"] = parameter.help;
    result["unit"] = parameter.unit;
    result["kind"] = nameOf(parameter.kind);
    result["default"] = objectOf(Value(parameter.usual));
    result["default_in_words"] = parameter.automaticText;
    result["is_advanced"] = parameter.isAdvanced;
    result["low"] = parameter.low;
    result["high"] = parameter.high > parameter.low ? nb::cast(parameter.high) : nb::none();
    result["is_low_open"] = parameter.isLowOpen;
    result["choices"] = parameter.choices;
    return result;
}

}  // namespace

Values valuesOf(const nb::dict& given) {
    Values values;
    for (const auto& [name, value] : given) {
        const auto key = nb::cast<std::string>(name);
        values[key] = valueOf(key, value);
    }
    return values;
}

nb::dict dictOf(Values&& report) {
    nb::dict result;
    for (auto& [name, value] : report) result[name.c_str()] = objectOf(std::move(value));
    return result;
}

nb::list listOf(const Warnings& warnings) {
    nb::list list;
    for (const Warning& one : warnings)
        list.append(nb::make_tuple(kindOf(one.code).name, one.text));
    return list;
}

nb::list describedFilters() {
    nb::list filters;
    for (const Filter& filter : allFilters()) {
        nb::dict result;
        nb::list parameters, report;
        for (const Parameter& one : filter.parameters) parameters.append(described(one));
        for (const ReportEntry& one : filter.report)
            report.append(nb::make_tuple(one.name, one.meaning, one.isAlways));
        result["name"] = filter.name;
        result["python_name"] = filter.pythonName;
        result["help"] = filter.help;
        result["source"] = filter.source;
        result["parameters"] = parameters;
        result["report"] = report;
        filters.append(result);
    }
    return filters;
}

nb::list describedPresets() {
    nb::list presets;
    for (const Preset& preset : allPresets())
        presets.append(nb::make_tuple(preset.name, preset.filter, preset.purpose,
                                      dictOf(Values(preset.options))));
    return presets;
}

nb::dict describedWarnings() {
    nb::dict kinds;
    for (const WarningKind& one : allWarnings()) kinds[one.name] = one.meaning;
    return kinds;
}

}  // namespace spectral::python
