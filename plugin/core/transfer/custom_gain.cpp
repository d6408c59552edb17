#include "core/transfer/custom_gain.h"

#include <algorithm>
#include <cmath>
#include <locale>
#include <memory>
#include <sstream>
#include <vector>

#include "core/support/errors.h"
#include "core/transfer/equalizer.h"
#include "core/transfer/expression.h"

namespace spectral {

namespace {

GivenText given(const std::string& text) {
    return {"transfer_function", text,
            "give points as size:gain, e.g. 20%:1, 5%:2, 1%:0.1, or an expression of w = feature "
            "size / wavelength, e.g. 1/(1 + w^4)"};
}

[[noreturn]] void reject(const std::string& text, std::size_t position, const std::string& why) {
    given(text).reject(position, why);
}

/// The number in text[begin, end), which holds nothing else but blanks.
double numberIn(const std::string& text, std::size_t begin, std::size_t end, const char* what) {
    std::istringstream input(text.substr(begin, end - begin));
    input.imbue(std::locale::classic());
    double number = 0.0;
    if (!(input >> number) || !(input >> std::ws).eof())
        reject(text, begin, std::string("expected a ") + what);
    return number;
}

/// The size in text[begin, end): `5%`, `6e` or a length.
double sizeIn(const std::string& text, std::size_t begin, std::size_t end,
              const MeshLengths& lengths) {
    const std::size_t last = text.find_last_not_of(' ', end - 1);
    double unit = 1.0;
    if (last != std::string::npos && last >= begin) {
        if (text[last] == '%') unit = 0.01 * lengths.diagonal;
        if (text[last] == 'e') unit = lengths.meanEdge;
        if (text[last] == '%' || text[last] == 'e') end = last;
    }
    const double size = unit * numberIn(text, begin, end, "size");
    if (!(size > 0.0) || !std::isfinite(size)) reject(text, begin, "a size must be above zero");
    return size;
}

/// The points in a text, in the order written.
std::vector<SizedGain> pointsOf(const std::string& text, const MeshLengths& lengths) {
    std::vector<SizedGain> points;
    for (std::size_t begin = 0, end = 0; end < text.size(); begin = end + 1) {
        end = std::min(text.find(',', begin), text.size());
        const std::size_t colon = text.find(':', begin);
        if (colon >= end) reject(text, begin, "expected a size, a colon and a gain");
        const double size = sizeIn(text, begin, colon, lengths);
        const double gain = numberIn(text, colon + 1, end, "gain");
        if (gain < 0.0) reject(text, colon + 1, "a gain must not be negative");
        points.push_back({size, gain});
    }
    return points;
}

/// The text with % behind every size.
std::string inPercent(std::string text) {
    for (std::size_t at = 0; (at = text.find(':', at)) != std::string::npos; at += 2)
        text.insert(at, "%");
    return text;
}

/// Points that are all larger than the mesh give every detail of it one gain: they scale it.
void checkSizes(const std::string& text, const std::vector<SizedGain>& points,
                const MeshLengths& lengths) {
    if (!(lengths.diagonal > 0.0) ||
        std::any_of(points.begin(), points.end(),
                    [&](const SizedGain& point) { return point.size <= lengths.diagonal; }))
        return;
    std::ostringstream why;
    why << "transfer_function = " << text
        << ": all sizes are larger than the mesh, whose diagonal is " << lengths.diagonal
        << ", so that it would only be scaled; ";
    if (text.find_first_of("%e") == std::string::npos)
        why << "did you mean " << inPercent(text) << "?";
    else
        why << "give smaller ones, such as 20%:1, 5%:2";
    throw InvalidOption(why.str());
}

Equalizer equalizerOf(const std::string& text, const MeshLengths& lengths) {
    const std::vector<SizedGain> points = pointsOf(text, lengths);
    if (points.size() == 1) {
        const std::size_t colon = text.find(':');
        const auto trimmed = [](const std::string& part) {
            const std::size_t begin = part.find_first_not_of(' ');
            return part.substr(begin, part.find_last_not_of(' ') + 1 - begin);
        };
        throw InvalidOption("transfer_function = " + text +
                            ": one point is one gain for all sizes, the whole shape's, too; give "
                            "a second one, such as 20%:1, or choose filter_type = band-pass with "
                            "feature_size = " +
                            trimmed(text.substr(0, colon)) + ", pass_gain = " +
                            trimmed(text.substr(colon + 1)) + " and stop_gain = 1");
    }
    checkSizes(text, points, lengths);
    try {
        return Equalizer(points);
    } catch (const InvalidOption& error) {
        throw InvalidOption("transfer_function = " + text + ": " + error.what());
    }
}

}  // namespace

CustomGain parseGain(const std::string& text, double cutoff, const MeshLengths& lengths) {
    // A colon in an expression belongs to `condition ? a : b`.
    const bool hasPoints =
        text.find(':') != std::string::npos && text.find('?') == std::string::npos;
    if (hasPoints) {
        const Equalizer equalizer = equalizerOf(text, lengths);
        return {equalizer, equalizer.middle()};
    }
    const auto expression =
        std::make_shared<Expression>(given(text), std::vector<std::string>{"w", "f", "l"});
    return {[expression, cutoff](double omega) {
                return (*expression)({omega / cutoff, omega, omega * omega});
            },
            cutoff};
}

}  // namespace spectral
