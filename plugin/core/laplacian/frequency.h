#pragma once

#include <functional>

namespace spectral {

/// Gain of a harmonic by its frequency omega = sqrt(lambda) >= 0, in radians per length unit; e.g.
/// a fractional power of a transfer function.
using Gain = std::function<double(double omega)>;

/// The cutoff frequency omega_c = 2 pi / featureSize, radians per length unit.
///
/// @param featureSize  wavelength of the cutoff, length units, > 0.
/// @throws InvalidOption  when it is not a finite length above zero.
double cutoffFrequency(double featureSize);

/// The feature size that suits a mesh when nobody says another: six mean edges, at most 5 % of the
/// diagonal of the bounding box. Six edges take the noise of the sampling away (a wave of two
/// edges, the finest that a mesh can carry, keeps 4 % of its height in a Gaussian low-pass); the
/// bound keeps the shape of a coarse model.
///
/// @param meanEdge, diagonal  length units; without edges (0) it is the bound.
double defaultFeatureSize(double meanEdge, double diagonal);

}  // namespace spectral
