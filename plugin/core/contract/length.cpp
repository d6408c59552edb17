#include "core/contract/length.h"

#include <cmath>
#include <limits>
#include <locale>
#include <sstream>

#include "core/support/errors.h"

namespace spectral {

namespace {

using Single = std::numeric_limits<float>;

}  // namespace

Length Length::parse(const std::string& text) {
    const std::size_t first = text.find_first_not_of(' ');
    std::string number = first == std::string::npos ? "" : text.substr(first);
    number.erase(number.find_last_not_of(' ') + 1);
    if (number == "auto") return {};
    Length length{0.0, Unit::Absolute};
    if (!number.empty() && number.back() == '%') length.unit = Unit::Percent;
    if (!number.empty() && number.back() == 'e') length.unit = Unit::Edges;
    if (length.unit != Unit::Absolute) number.pop_back();
    std::istringstream input(number);
    input.imbue(std::locale::classic());
    const bool isNumber = input >> length.value && (input >> std::ws).eof();
    if (!isNumber || length.value < Single::min() || length.value > Single::max()) {
        const std::string limit = isNumber ? limitOfSinglePrecision(length.value) : "";
        throw InvalidOption((isNumber ? text : "'" + text + "'") + ": give " + kLengthForms +
                            (limit.empty() ? ", above zero" : limit));
    }
    if (length.unit == Unit::Percent && length.value > 100.0)
        throw InvalidOption(text + ": a percentage goes up to 100% of the diagonal");
    return length;
}

double Length::in(const MeshLengths& mesh, double automatic) const {
    switch (unit) {
        case Unit::Automatic: return automatic;
        case Unit::Percent: {
            const float share = static_cast<float>(value) / 100.0F;
            const float length = static_cast<float>(mesh.diagonal) * share;
            return length == 0.0F || std::isinf(length) ? mesh.diagonal * value / 100.0 : length;
        }
        case Unit::Edges: return inSinglePrecision(value * mesh.meanEdge);
        case Unit::Absolute: break;
    }
    return inSinglePrecision(value);
}

std::string limitOfSinglePrecision(double number) {
    if (number > Single::max()) return ", at most " + textOf(Single::max());
    return number > 0.0 && number < Single::min() ? ", at least " + textOf(Single::min()) : "";
}

double inSinglePrecision(double number) {
    const auto single = static_cast<float>(number);
    return single == 0.0F || std::isinf(single) ? number : static_cast<double>(single);
}

}  // namespace spectral
