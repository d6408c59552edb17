#include "core/transfer/custom_gain.h"

#include <muParserDLL.h>

#include <algorithm>
#include <cmath>
#include <locale>
#include <memory>
#include <sstream>
#include <utility>
#include <vector>

#include "core/support/errors.h"

namespace spectral {

namespace {

constexpr const char* kExamples =
    "; give points as size:gain, e.g. 20%:1, 5%:2, 1%:0.1, or an expression of w = feature size / "
    "wavelength, e.g. 1/(1 + w^4)";

/// What a gain of 0 at a point stands for, because it has no logarithm: nothing that one can see.
constexpr double kNoGain = 1e-3;

/// @param position  from 0.
[[noreturn]] void reject(const std::string& text, std::size_t position, const std::string& why) {
    const std::size_t place = std::min(position, text.size()) + 1;
    throw InvalidOption("transfer_function = " + text + ": at character " + std::to_string(place) +
                        ", " + why + kExamples);
}

/// A muParser expression with its variables. The interface of C, because that of C++ differs
/// between the versions that programs ship.
class Expression {
  public:
    Expression(const std::string& text, double cutoff)
        : parser_(mupCreate(muBASETYPE_FLOAT)), cutoff_(cutoff) {
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

/// A point of an equalizer.
struct Point {
    double octave = 0.0;  // log2 omega
    double level = 0.0;   // log2 of the gain
    double slope = 0.0;   // of the level, per octave
};

/// Interpolates the level, so that a fractional power of the points is that of the function: smooth
/// and monotone between points of ascending frequency, constant beyond them.
class Equalizer {
  public:
    explicit Equalizer(std::vector<Point> points) : points_(std::move(points)) {
        // Steeper slopes than the lesser secant's would overshoot.
        for (std::size_t i = 1; i + 1 < points_.size(); ++i) {
            const double left = secant(i - 1), right = secant(i);
            if (left * right > 0.0)
                points_[i].slope = std::abs(left) < std::abs(right) ? left : right;
        }
    }

    double operator()(double omega) const { return std::exp2(level(std::log2(omega))); }

    /// Frequency in the middle of the points.
    double middle() const {
        return std::exp2(0.5 * (points_.front().octave + points_.back().octave));
    }

  private:
    double level(double octave) const {
        const auto next =
            std::upper_bound(points_.begin(), points_.end(), octave,
                             [](double value, const Point& p) { return value < p.octave; });
        if (next == points_.begin()) return next->level;
        const Point& a = *(next - 1);
        if (next == points_.end()) return a.level;
        const Point& b = *next;
        // From the tangent at one point to that at the other, with three continuous derivatives.
        const double t = (octave - a.octave) / (b.octave - a.octave);
        const double blend = t * t * t * t * (35.0 - t * (84.0 - t * (70.0 - t * 20.0)));
        return (1.0 - blend) * (a.level + (octave - a.octave) * a.slope) +
               blend * (b.level + (octave - b.octave) * b.slope);
    }

    /// Slope of the line from point i to the next.
    double secant(std::size_t i) const {
        return (points_[i + 1].level - points_[i].level) /
               (points_[i + 1].octave - points_[i].octave);
    }

    std::vector<Point> points_;
};

/// The number that is all of text[begin, end), but for blanks.
double numberIn(const std::string& text, std::size_t begin, std::size_t end, const char* what) {
    std::istringstream input(text.substr(begin, end - begin));
    input.imbue(std::locale::classic());
    double number = 0.0;
    if (!(input >> number) || !(input >> std::ws).eof())
        reject(text, begin, std::string("there must be a ") + what);
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

/// The points of a text, by ascending frequency.
std::vector<Point> pointsOf(const std::string& text, const MeshLengths& lengths) {
    std::vector<Point> points;
    for (std::size_t begin = 0, end = 0; end < text.size(); begin = end + 1) {
        end = std::min(text.find(',', begin), text.size());
        const std::size_t colon = text.find(':', begin);
        if (colon >= end) reject(text, begin, "there must be a size, a colon and a gain");
        const double size = sizeIn(text, begin, colon, lengths);
        const double gain = numberIn(text, colon + 1, end, "gain");
        if (gain < 0.0) reject(text, colon + 1, "a gain must not be negative");
        points.push_back(
            {std::log2(cutoffFrequency(size)), std::log2(gain > 0.0 ? gain : kNoGain), 0.0});
    }
    const auto comesBefore = [](const Point& a, const Point& b) { return a.octave < b.octave; };
    std::sort(points.begin(), points.end(), comesBefore);
    for (std::size_t i = 0; i + 1 < points.size(); ++i)
        if (!(points[i].octave < points[i + 1].octave))
            throw InvalidOption("transfer_function = " + text +
                                ": two points have the same size; a size has one gain");
    return points;
}

}  // namespace

CustomGain parseGain(const std::string& text, double cutoff, const MeshLengths& lengths) {
    // A colon in an expression belongs to `condition ? a : b`.
    const bool hasPoints =
        text.find(':') != std::string::npos && text.find('?') == std::string::npos;
    if (hasPoints) {
        const Equalizer equalizer(pointsOf(text, lengths));
        return {equalizer, equalizer.middle()};
    }
    const auto expression = std::make_shared<Expression>(text, cutoff);
    return {[expression](double omega) { return (*expression)(omega); }, cutoff};
}

}  // namespace spectral
