#include "core/transfer/custom_gain.h"

#include <muParserDLL.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <locale>
#include <memory>
#include <sstream>
#include <vector>

#include "core/support/errors.h"
#include "core/transfer/equalizer.h"

namespace spectral {

namespace {

constexpr const char* kExamples =
    "; give points as size:gain, e.g. 20%:1, 5%:2, 1%:0.1, or an expression of w = feature size / "
    "wavelength, e.g. 1/(1 + w^4)";

/// @param position  index of the character, from 0.
[[noreturn]] void reject(const std::string& text, std::size_t position, const std::string& why) {
    const std::size_t place = std::min(position, text.size()) + 1;
    throw InvalidOption("transfer_function = " + text + ": at character " + std::to_string(place) +
                        ", " + why + kExamples);
}

bool isComparison(const std::string& text, std::size_t at) {
    return text[at] == '<' || text[at] == '>' ||
           (text[at + 1] == '=' && (text[at] == '=' || text[at] == '!'));
}

/// Rejects what muParser accepts but does not read as mathematics: assignments, comparisons that
/// seem to chain, and several results, of which it takes the last.
void rejectMisreadings(const std::string& text) {
    struct Group {
        bool isCall;      ///< Its commas separate the arguments of a function.
        bool isCompared;  ///< Its current operand of &&, ||, ? or : contains a comparison.
    };
    std::vector<Group> groups{{false, false}};
    char previous = ' ';  // the last character that is not blank
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        Group& group = groups.back();
        if (c == '(') {
            const bool followsName = std::isalnum(static_cast<unsigned char>(previous)) != 0;
            groups.push_back({followsName || previous == '_', false});
        } else if (c == ')') {
            if (groups.size() > 1) groups.pop_back();  // muParser reports one too many
        } else if (c == ',') {
            if (!group.isCall)
                reject(text, i, "a comma; write decimals with a point, 0.5, and one expression");
            group.isCompared = false;
        } else if (c == '&' || c == '|' || c == '?' || c == ':') {
            group.isCompared = false;
        } else if (isComparison(text, i)) {
            if (group.isCompared)
                reject(text, i, "a second comparison; join two by &&, as in 0.5 < w && w < 1.5");
            group.isCompared = true;
            if (text[i + 1] == '=') ++i;
        } else if (c == '=') {
            reject(text, i, "= assigns; compare with ==");
        }
        if (text[i] != ' ') previous = text[i];
    }
}

/// A muParser expression with its variables. Uses muParser's C interface, as the C++ one differs
/// between versions.
class Expression {
  public:
    Expression(const std::string& text, double cutoff)
        : parser_(mupCreate(muBASETYPE_FLOAT)), cutoff_(cutoff) {
        rejectMisreadings(text);
        mupDefineVar(parser_.get(), "w", &w_);
        mupDefineVar(parser_.get(), "f", &f_);
        mupDefineVar(parser_.get(), "l", &l_);
        mupSetExpr(parser_.get(), text.c_str());
        (*this)(cutoff);
        if (mupError(parser_.get()) == 0) return;
        const int position = std::max(0, mupGetErrorPos(parser_.get()));
        std::string message = mupGetErrorMsg(parser_.get());
        while (!message.empty() && (message.back() == '.' || message.back() == ' '))
            message.pop_back();
        reject(text, static_cast<std::size_t>(position), message);
    }

    double operator()(double omega) {
        w_ = omega / cutoff_;
        f_ = omega;
        l_ = omega * omega;
        return mupEval(parser_.get());
    }

  private:
    struct Release {
        void operator()(void* parser) const { mupRelease(parser); }
    };
    std::unique_ptr<void, Release> parser_;
    double cutoff_;
    double w_ = 0.0, f_ = 0.0, l_ = 0.0;
};

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
    const auto expression = std::make_shared<Expression>(text, cutoff);
    return {[expression](double omega) { return (*expression)(omega); }, cutoff};
}

}  // namespace spectral
