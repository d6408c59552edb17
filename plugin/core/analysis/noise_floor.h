#pragma once

#include <Eigen/Core>

namespace spectral {

/// The small details of a shape that are indistinguishable from noise on its vertices.
struct NoiseFloor {
    double height = 0.0;       ///< Root mean square height of the noise, length units; 0: none.
    double featureSize = 0.0;  ///< Largest feature size of these details, length units; 0: none.
};

/// Finds where the spectrum of a shape turns into that of white noise.
///
/// Independent vertex noise, of equal root mean square height across the surface, has a known share
/// of its energy in each band of a mesh. So the height of noise that would explain a band is
/// amplitude / noise. For relief this falls towards small features; it levels off where there is
/// noise, or detail as small as the edges, which cannot be told from it.
///
/// From the smallest features up, a band belongs to the floor as long as it takes at most 1.6 times
/// the height that explains all smaller ones together. The smallest bands that hold 5 % of the
/// noise are always accepted; if the next one fails, there is no floor.
///
/// The height is that of all bands of the floor except the last, which has the most relief; relief
/// in the others makes it up to 20 % too large. Noise higher than about a quarter of the edge
/// length folds the surface and changes its harmonics: its height and feature size are
/// underestimated.
///
/// @param featureSize  feature sizes of the bands, third octaves, length units, descending.
/// @param amplitude    root mean square height of the shape in each band, length units.
/// @param noise        the same for noise of height 1, > 0.
NoiseFloor noiseFloor(const Eigen::VectorXd& featureSize, const Eigen::VectorXd& amplitude,
                      const Eigen::VectorXd& noise);

}  // namespace spectral
