#include "values.h"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <string>
#include <utility>

#include "arrays.h"
#include "core/contract/length.h"
#include "core/contract/presets.h"
#include "core/support/errors.h"

namespace spectral::python {

namespace {

Value valueOf(nb::handle given) {
    if (nb::isinstance<nb::bool_>(given)) return nb::cast<bool>(given);
    if (nb::isinstance<nb::str>(given)) return nb::cast<std::string>(given);
    // Not by the slot: arrays of NumPy have __index__, whatever numbers they hold.
    const nb::object index = nb::steal(PyNumber_Index(given.ptr()));
    if (!index.is_valid()) PyErr_Clear();
    if (int integer = 0; index.is_valid() && nb::try_cast(index, integer)) return integer;
    if (double number = 0.0; nb::try_cast(given, number)) return number;
    return nb::cast<std::string>(nb::str(given));  // no option takes it: the error shows it
}

/// A length in the units of the mesh: value, unit ("", "%", "e") and whether it is automatic.
nb::tuple tupleOf(const Length& length) {
    using Unit = Length::Unit;
    const char* const unit = length.unit == Unit::Percent ? "%"
                             : length.unit == Unit::Edges ? "e"
                                                          : "";
    return nb::make_tuple(length.value, unit, length.unit == Unit::Automatic);
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
    result["range"] = parameter.range;
    result["kind"] = nameOf(parameter.kind);
    result["default"] = objectOf(Value(parameter.usual));
    result["default_in_words"] = parameter.automaticText;
    result["is_advanced"] = parameter.isAdvanced;
    result["choices"] = parameter.choices;
    return result;
}

}  // namespace

Values valuesOf(const nb::dict& given) {
    Values values;
    for (const auto& [name, value] : given) values[nb::cast<std::string>(name)] = valueOf(value);
    return values;
}

nb::dict dictOf(Values&& report) {
    nb::dict result;
    for (auto& [name, value] : report) result[name.c_str()] = objectOf(std::move(value));
    return result;
}

nb::tuple parsedLength(const std::string& text) { return tupleOf(Length::parse(text)); }

nb::dict checkedOptions(const std::string& filter, const nb::dict& given) {
    nb::dict result;
    const Values values = valuesOf(given);
    for (const Parameter& one : filterNamed(filter).parameters) {
        const auto found = values.find(one.name);
        if (found == values.end()) continue;
        Value value = checked(one, found->second);
        if (one.kind != Parameter::Kind::Length)
            result[one.name.c_str()] = objectOf(std::move(value));
        else if (const auto* const text = std::get_if<std::string>(&value))
            result[one.name.c_str()] = parsedLength(*text);
        else
            result[one.name.c_str()] = tupleOf({std::get<double>(value), Length::Unit::Absolute});
    }
    return result;
}

nb::dict sizesOf(const std::string& filter, const nb::dict& given, double diagonal, double meanEdge,
                 double surfaceDiagonal) {
    nb::dict sizes;
    const Values values = valuesOf(given);
    for (const Parameter& one : filterNamed(filter).parameters) {
        if (one.kind != Parameter::Kind::Length) continue;
        const auto found = values.find(one.name);
        const Value& value = found == values.end() ? one.usual : found->second;
        const double size =
            std::get<double>(converted(one, value, {diagonal, meanEdge, surfaceDiagonal}));
        sizes[one.name.c_str()] = size > 0.0 ? nb::cast(size) : nb::none();
    }
    return sizes;
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
