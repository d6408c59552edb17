#pragma once

#include <vector>

namespace spectral {

/// A gain at a size of details.
struct SizedGain {
    double size = 0.0;  ///< Wavelength, length units, > 0.
    double gain = 0.0;  ///< >= 0.
};

/// The gain through some points, smooth and monotone between them.
///
/// The logarithm of the gain is interpolated over log omega, so that a fractional power of the
/// points gives that power of the gain. Beyond the first and the last point the gain is theirs. A
/// gain of 0, which has no logarithm, stands for 0.001: nothing that one can see.
class Equalizer {
  public:
    /// @param points  at least one, in any order.
    /// @throws InvalidOption  when a size is not a finite length above zero, a gain is negative or
    ///                        not finite, or two points have the same size.
    explicit Equalizer(const std::vector<SizedGain>& points);

    /// Gain at the frequency omega >= 0, radians per length unit; 1 exactly where it is 1 at all
    /// points around.
    double operator()(double omega) const;

    /// Frequency in the middle of the points on the scale of log omega, radians per length unit.
    double middle() const;

    /// Its wavelength, length units.
    double middleSize() const;

  private:
    struct Point {
        double octave = 0.0;  // log2 omega
        double level = 0.0;   // log2 of the gain
        double slope = 0.0;   // of the level, per octave
    };

    double level(double octave) const;
    double secant(std::size_t i) const;

    std::vector<Point> points_;  // by ascending frequency
};

/// The gain of sliders an octave apart, for details of 1, 2, 4, ... times the smallest size. The
/// first acts on all finer details, too; details larger than twice the largest keep a gain of 1.
///
/// @param smallestSize  length units, > 0.
/// @param gains         from fine to coarse, >= 0, at least one.
/// @throws InvalidOption  when one of them is out of its range.
Equalizer octaveEqualizer(double smallestSize, const std::vector<double>& gains);

}  // namespace spectral
