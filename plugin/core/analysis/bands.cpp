#include "core/analysis/bands.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace spectral {

namespace {

/// Largest overlap of two windows, in octaves: a smaller one separates sizes better, but takes
/// larger Krylov spaces.
constexpr double kTransition = 0.5;

}  // namespace

Bands::Bands(double diagonal, double lowest, double highest, int perOctave)
    : diagonal_(diagonal),
      perOctave_(perOctave),
      transition_(std::min(kTransition, 1.0 / perOctave)) {
    const auto number = [&](double omega) {
        return static_cast<int>(std::lround(perOctave * std::log2(omega * diagonal / (2.0 * kPi))));
    };
    first_ = number(lowest);
    count_ = number(highest) - first_ + 1;
}

double Bands::featureSize(int j) const {
    return diagonal_ * std::exp2(-static_cast<double>(first_ + j) / perOctave_);
}

double Bands::edge(int j) const { return diagonal_ * std::exp2(-(first_ + j + 0.5) / perOctave_); }

int Bands::nearest(double featureSize) const {
    const long number = std::lround(perOctave_ * std::log2(diagonal_ / featureSize)) - first_;
    return static_cast<int>(std::clamp(number, 0L, count_ - 1L));
}

double Bands::window(int j, double omega) const { return below(j, omega) - below(j - 1, omega); }

double Bands::end(int j) const {
    if (j == count_ - 1) return std::numeric_limits<double>::infinity();
    return 2.0 * kPi / edge(j) * std::exp2(0.5 * transition_);
}

/// The fraction of a harmonic in bands 0 to `edge`.
double Bands::below(int edge, double omega) const {
    if (edge < 0) return 0.0;
    if (edge >= count_ - 1) return 1.0;
    const double octavesBeyond = std::log2(omega * this->edge(edge) / (2.0 * kPi));
    const double t = std::clamp(octavesBeyond / transition_ + 0.5, 0.0, 1.0);
    const double cosine = std::cos(0.5 * kPi * t);
    return cosine * cosine;
}

}  // namespace spectral
