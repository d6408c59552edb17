#include "core/transfer/sampled_gain.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/support/types.h"

namespace spectral {

namespace {

/// The gain used in place of 0.
constexpr double kNoGain = 1e-12;

}  // namespace

SampledGain::SampledGain(const Eigen::MatrixXd& samples) {
    assert(samples.rows() > 0 && samples.cols() == 2);
    for (Index i = 0; i < samples.rows(); ++i)
        points_.push_back(
            {std::log2(samples(i, 0)), std::log2(std::max(samples(i, 1), kNoGain)), 0.0});
    for (std::size_t i = 2; i + 2 < points_.size(); ++i) points_[i].slope = slope(i);
}

double SampledGain::operator()(double w) const {
    const double octave = std::log2(w);
    const auto next =
        std::upper_bound(points_.begin(), points_.end(), octave,
                         [](double value, const Point& p) { return value < p.octave; });
    if (next == points_.begin()) return std::exp2(next->level);
    const Point& a = *(next - 1);
    if (next == points_.end()) return std::exp2(a.level);
    const Point& b = *next;
    const double h = b.octave - a.octave, t = (octave - a.octave) / h, s = 1.0 - t;
    const double blend = t * t * (3.0 - 2.0 * t);
    const double bend = h * t * s * (s * a.slope - t * b.slope);
    return std::exp2(a.level + blend * (b.level - a.level) + bend);
}

/// Slope of the line from point i to point i + 1.
double SampledGain::secant(std::size_t i) const {
    return (points_[i + 1].level - points_[i].level) / (points_[i + 1].octave - points_[i].octave);
}

/// Akima 1970, Eq. 1: of the lines on both sides, the one that changes less towards its side counts
/// more.
double SampledGain::slope(std::size_t i) const {
    const double left = secant(i - 1), right = secant(i);
    const double byLeft = std::abs(secant(i + 1) - right), byRight = std::abs(left - secant(i - 2));
    if (byLeft + byRight == 0.0) return 0.5 * (left + right);
    return (byLeft * left + byRight * right) / (byLeft + byRight);
}

}  // namespace spectral
