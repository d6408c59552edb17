#pragma once

#include <Eigen/Core>
#include <vector>

namespace spectral {

/// A gain interpolated between close samples of a function.
///
/// The logarithm of the gain is a cubic spline in log w with the slopes of Akima 1970: to third
/// order in the distance of the samples where the function is smooth, so that it is evaluated as
/// fast and as accurately as a formula, and without overshoot where it jumps. Beyond the first and
/// the last sample the gain is constant. A gain of 0, which has no logarithm, becomes 1e-12.
class SampledGain {
  public:
    /// @param samples  k x 2, k >= 1: w, finite, > 0, ascending, and the gains there, finite, >= 0.
    explicit SampledGain(const Eigen::MatrixXd& samples);

    /// Gain at w >= 0; exactly 1 where it is 1 at the six samples around.
    double operator()(double w) const;

  private:
    struct Point {
        double octave = 0.0;  // log2 w
        double level = 0.0;   // log2 of the gain
        double slope = 0.0;   // derivative of the level, per octave
    };

    double secant(std::size_t i) const;
    double slope(std::size_t i) const;

    std::vector<Point> points_;  // ascending
};

}  // namespace spectral
