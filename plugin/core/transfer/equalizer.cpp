#include "core/transfer/equalizer.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/support/errors.h"
#include "core/support/frequency.h"
#include "core/support/types.h"

namespace spectral {

namespace {

/// The gain used in place of 0.
constexpr double kNoGain = 1e-3;

}  // namespace

Equalizer::Equalizer(const std::vector<SizedGain>& points) {
    assert(!points.empty());
    for (const auto& [size, gain] : points) {
        const double omega = cutoffFrequency(size);
        if (!std::isfinite(gain) || gain < 0.0)
            throw InvalidOption("gain = " + textOf(gain) + " for details of size " + textOf(size) +
                                ": a gain must be finite and not negative; 0 removes, 1 keeps, 2 "
                                "doubles");
        points_.push_back({std::log2(omega), std::log2(gain > 0.0 ? gain : kNoGain), 0.0});
    }
    std::sort(points_.begin(), points_.end(),
              [](const Point& a, const Point& b) { return a.octave < b.octave; });
    for (std::size_t i = 0; i + 1 < points_.size(); ++i)
        if (!(points_[i].octave < points_[i + 1].octave))
            throw InvalidOption("two points have the same size; give one gain for each size");
    // Slopes steeper than the flatter of both secants would overshoot.
    for (std::size_t i = 1; i + 1 < points_.size(); ++i) {
        const double left = secant(i - 1), right = secant(i);
        if (left * right > 0.0) points_[i].slope = std::abs(left) < std::abs(right) ? left : right;
    }
}

double Equalizer::operator()(double omega) const { return std::exp2(level(std::log2(omega))); }

double Equalizer::middle() const {
    return std::exp2(0.5 * (points_.front().octave + points_.back().octave));
}

double Equalizer::middleSize() const { return 2.0 * kPi / middle(); }

double Equalizer::level(double octave) const {
    const auto next =
        std::upper_bound(points_.begin(), points_.end(), octave,
                         [](double value, const Point& p) { return value < p.octave; });
    if (next == points_.begin()) return next->level;
    const Point& a = *(next - 1);
    if (next == points_.end()) return a.level;
    const Point& b = *next;
    // Blend between the tangents at both points, with three continuous derivatives.
    const double t = (octave - a.octave) / (b.octave - a.octave);
    const double blend = t * t * t * t * (35.0 - t * (84.0 - t * (70.0 - t * 20.0)));
    return (1.0 - blend) * (a.level + (octave - a.octave) * a.slope) +
           blend * (b.level + (octave - b.octave) * b.slope);
}

/// Slope of the line from point i to point i + 1.
double Equalizer::secant(std::size_t i) const {
    return (points_[i + 1].level - points_[i].level) / (points_[i + 1].octave - points_[i].octave);
}

Equalizer octaveEqualizer(double smallestSize, const std::vector<double>& gains) {
    if (!std::isfinite(smallestSize) || smallestSize <= 0.0)
        throw InvalidOption("smallest_size = " + textOf(smallestSize) +
                            ": must be a length above zero, e.g. three mean edges");
    std::vector<SizedGain> points;
    double size = smallestSize;
    for (const double gain : gains) {
        points.push_back({size, gain});
        size *= 2.0;
    }
    points.push_back({size, 1.0});
    return Equalizer(points);
}

}  // namespace spectral
