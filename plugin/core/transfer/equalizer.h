#pragma once

#include <vector>

namespace spectral {

/// The gain for details of one size.
struct SizedGain {
    double size = 0.0;  ///< Wavelength, length units, > 0.
    double gain = 0.0;  ///< >= 0.
};

/// A gain through given points, smooth and monotone between them.
///
/// The logarithm of the gain is interpolated over log omega, so that a fractional power of the
/// points gives that power of the gain. Beyond the first and the last point the gain is constant. A
/// gain of 0, which has no logarithm, becomes 0.001: the difference is invisible.
class Equalizer {
  public:
    /// @param points  at least one, in any order.
    /// @throws InvalidOption  when a size is not a finite length above zero, a gain is negative or
    ///                        not finite, or two points have the same size.
    explicit Equalizer(const std::vector<SizedGain>& points);

    /// Gain at the frequency omega >= 0, radians per length unit; exactly 1 where it is 1 at the
    /// neighbouring points.
    double operator()(double omega) const;

    /// Frequency in the middle of the range of points, on the scale of log omega; radians per
    /// length unit.
    double middle() const;

    /// Wavelength of middle(), length units.
    double middleSize() const;

  private:
    struct Point {
        double octave = 0.0;  // log2 omega
        double level = 0.0;   // log2 of the gain
        double slope = 0.0;   // derivative of the level, per octave
    };

    double level(double octave) const;
    double secant(std::size_t i) const;

    std::vector<Point> points_;  // by ascending frequency
};

/// An equalizer with points an octave apart, for details of 1, 2, 4, ... times the smallest size.
/// The first gain also applies to all finer details; from twice the largest size on the gain is 1.
///
/// @param smallestSize  length units, > 0.
/// @param gains         from fine to coarse, >= 0, at least one.
/// @throws InvalidOption  when an argument is out of range.
Equalizer octaveEqualizer(double smallestSize, const std::vector<double>& gains);

}  // namespace spectral
