#pragma once

#include <functional>

namespace spectral {

/// Gain at a frequency omega = sqrt(lambda) >= 0, in radians per length unit.
using Gain = std::function<double(double omega)>;

/// The cutoff frequency omega_c = 2 pi / featureSize, radians per length unit.
///
/// @param featureSize  wavelength of the cutoff, length units, > 0.
/// @throws InvalidOption  when it is not a finite length above zero.
double cutoffFrequency(double featureSize);

/// Default feature size: six mean edges, at most 5 % of the diagonal of the bounding box.
///
/// At six edges a Gaussian low-pass removes sampling noise: it leaves 4 % of the shortest wave that
/// a mesh can represent, two edges long. The bound preserves the shape of a coarse mesh.
///
/// @param meanEdge, diagonal  length units; meanEdge = 0 gives the bound.
double defaultFeatureSize(double meanEdge, double diagonal);

/// Default size of the smallest details of an equalizer: three mean edges, at most 2.5 % of the
/// diagonal, half of the default feature size.
///
/// A mesh holds no wave shorter than two edges, and one of three already poorly. The bound keeps
/// the sliders of a coarse mesh below the size of its shape.
double defaultSmallestSize(double meanEdge, double diagonal);

}  // namespace spectral
