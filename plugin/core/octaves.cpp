#include "octaves.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace spectral {

namespace {

/// Octaves over which one window gives way to the next: narrower ones tell sizes apart better, but
/// quadrature resolves them worse.
constexpr double kTransition = 0.5;

}  // namespace

Octaves::Octaves(double diagonal, double lowest, double highest) : diagonal_(diagonal) {
    const auto nearest = [&](double omega) {
        return static_cast<int>(std::lround(std::log2(omega * diagonal / (2.0 * kPi))));
    };
    first_ = nearest(lowest);
    count_ = nearest(highest) - first_ + 1;
}

double Octaves::featureSize(int j) const { return diagonal_ * std::exp2(-(first_ + j)); }

double Octaves::edge(int j) const { return diagonal_ * std::exp2(-(first_ + j + 0.5)); }

double Octaves::window(int j, double omega) const { return below(j, omega) - below(j - 1, omega); }

double Octaves::end(int j) const {
    if (j == count_ - 1) return std::numeric_limits<double>::infinity();
    return 2.0 * kPi / edge(j) * std::exp2(0.5 * kTransition);
}

/// The part of a harmonic that counts as below the edge of octaves `edge` and `edge` + 1.
double Octaves::below(int edge, double omega) const {
    if (edge < 0) return 0.0;
    if (edge >= count_ - 1) return 1.0;
    const double octavesBeyond = std::log2(omega * this->edge(edge) / (2.0 * kPi));
    const double t = std::clamp(octavesBeyond / kTransition + 0.5, 0.0, 1.0);
    const double cosine = std::cos(0.5 * kPi * t);
    return cosine * cosine;
}

}  // namespace spectral
