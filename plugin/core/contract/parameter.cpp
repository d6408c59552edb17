#include "core/contract/parameter.h"

#include <cmath>
#include <iomanip>
#include <limits>
#include <sstream>

#include "core/contract/length.h"
#include "core/support/errors.h"

namespace spectral {

namespace {

using Kind = Parameter::Kind;

std::string shown(const Value& value) {
    struct {
        std::string operator()(bool is) const { return is ? "true" : "false"; }
        std::string operator()(int number) const { return std::to_string(number); }
        std::string operator()(double number) const { return textOf(number); }
        std::string operator()(const std::string& text) const { return text; }
        std::string operator()(const Eigen::VectorXd&) const { return "a list"; }
    } text;
    return std::visit(text, value);
}

[[noreturn]] void reject(const Parameter& parameter, const Value& value,
                         const std::string& wanted) {
    throw InvalidOption(parameter.name + " = " + shown(value) + ": " + wanted);
}

int choiceOf(const Parameter& parameter, const Value& value) {
    const std::vector<std::string>& choices = parameter.choices;
    const auto count = static_cast<int>(choices.size());
    const int* const number = std::get_if<int>(&value);
    if (number != nullptr && *number >= 0 && *number < count) return *number;
    std::string all;
    for (int i = 0; i < count; ++i) {
        const std::string& choice = choices[static_cast<std::size_t>(i)];
        if (const auto* const name = std::get_if<std::string>(&value); name && *name == choice)
            return i;
        all += (i > 0 ? ", " : "") +
               (number != nullptr ? std::to_string(i) + " (" + choice + ")" : choice);
    }
    reject(parameter, value, "choose " + all);
}

/// A number in range that is one in single precision, too, in which MeshLab passes numbers on.
double numberOf(const Parameter& parameter, const Value& value) {
    double number = 0.0;
    if (const auto* const integer = std::get_if<int>(&value))
        number = *integer;
    else if (const auto* const real = std::get_if<double>(&value))
        number = *real;
    else
        reject(parameter, value, "must be a number");
    using Single = std::numeric_limits<float>;
    const double low = parameter.low + (parameter.isLowOpen ? Single::min() : 0.0);
    const bool isBounded = parameter.high > parameter.low;
    const bool isWhole = parameter.kind != Kind::Integer || std::holds_alternative<int>(value);
    if (isWhole && number >= low && number <= (isBounded ? parameter.high : Single::max()))
        return number;
    std::string wanted = parameter.kind == Kind::Integer ? "must be an integer, " : "must be ";
    wanted += rangeOf(parameter);
    if (parameter.kind == Kind::Length) wanted += std::string(": give ") + kLengthForms;
    if (!isBounded || number < parameter.high) wanted += limitOfSinglePrecision(number);
    reject(parameter, value, wanted);
}

/// Rejects a length that no filter can have been meant to take.
double inProportion(double length, const Parameter& parameter, const Value& value,
                    const MeshLengths& mesh) {
    constexpr double kRoundOff = 1.001;
    const double share = length / mesh.diagonal;  // not finite without a mesh
    if (!std::isfinite(share) || share <= kRoundOff * parameter.largestShare) return length;
    std::ostringstream wanted;
    wanted << std::setprecision(3) << "is " << 100.0 * share << " % of the diagonal of the mesh, "
           << mesh.diagonal << ": give at most " << 100.0 * parameter.largestShare << "%";
    const double* const number = std::get_if<double>(&value);
    const double percent = number != nullptr ? *number : length;
    if (!std::holds_alternative<std::string>(value) && percent <= 100.0 * parameter.largestShare)
        wanted << "; did you mean " << percent << "%?";
    reject(parameter, value, wanted.str());
}

double lengthOf(const Parameter& parameter, const Value& value, const MeshLengths& mesh) {
    const double automatic = inSinglePrecision(automaticLength(parameter, mesh));
    const auto* const text = std::get_if<std::string>(&value);
    if (text == nullptr)
        return inProportion(inSinglePrecision(numberOf(parameter, value)), parameter, value, mesh);
    if (value == parameter.usual) return automatic;
    const Length length = [&] {
        try {
            return Length::parse(*text);
        } catch (const InvalidOption& error) {
            throw InvalidOption(parameter.name + " = " + error.what());
        }
    }();
    // A batch of coarse and fine meshes may have one size in edges.
    if (length.unit == Length::Unit::Edges) return length.in(mesh, automatic);
    const Value given = length.unit == Length::Unit::Absolute ? Value(length.value) : value;
    return inProportion(length.in(mesh, automatic), parameter, given, mesh);
}

}  // namespace

Value converted(const Parameter& parameter, const Value& value, const MeshLengths& mesh) {
    switch (parameter.kind) {
        case Kind::Bool:
            if (!std::holds_alternative<bool>(value))
                reject(parameter, value, "must be true or false");
            return value;
        case Kind::Integer: return static_cast<int>(numberOf(parameter, value));
        case Kind::Number: return numberOf(parameter, value);
        case Kind::Length: return lengthOf(parameter, value, mesh);
        case Kind::Choice: return choiceOf(parameter, value);
        case Kind::Text:
            if (!std::holds_alternative<std::string>(value))
                reject(parameter, value, "must be a text");
            break;
    }
    return value;
}

std::string rangeOf(const Parameter& parameter) {
    const std::string low = textOf(parameter.low), high = textOf(parameter.high);
    const bool isBounded = parameter.high > parameter.low;
    if (parameter.isLowOpen) return "above " + low + (isBounded ? ", at most " + high : "");
    return isBounded ? low + " to " + high : "at least " + low;
}

Value checked(const Parameter& parameter, const Value& value) {
    const Value found = converted(parameter, value, {});
    if (parameter.kind == Kind::Choice)
        return parameter.choices[static_cast<std::size_t>(std::get<int>(found))];
    if (parameter.kind != Kind::Length) return found;
    if (const auto* const text = std::get_if<std::string>(&value)) return *text;
    const double number = numberOf(parameter, value);
    if (number == 0.0) return std::string("auto");  // of those with 0 in range, as in dialogs
    return number;
}

void rejectUnknown(const std::vector<Parameter>& parameters, const Values& given) {
    std::string all;
    Values unknown = given;
    for (const Parameter& one : parameters) {
        all += (all.empty() ? "" : ", ") + one.name;
        unknown.erase(one.name);
    }
    throw InvalidOption("there is no option " + unknown.begin()->first + ": choose " + all);
}

double automaticLength(const Parameter& parameter, const MeshLengths& mesh) {
    return parameter.automatic != nullptr ? parameter.automatic(mesh) : 0.0;
}

}  // namespace spectral
