#pragma once

#include <Eigen/Core>

namespace spectral {

/// The small details of a shape that are like noise of its vertices.
struct NoiseFloor {
    double height = 0.0;  ///< Root mean square height of that noise, length units; 0: none seen.
    double featureSize = 0.0;  ///< The details up to this feature size, length units; 0: none seen.
};

/// Finds where the spectrum of a shape turns into that of white noise.
///
/// Noise that displaces every vertex by itself, by one and the same root mean square height across
/// the surface, has a known part of its energy in every band of a mesh. So every band of a shape
/// has a height of noise that would explain it: amplitude / noise. For relief it falls towards
/// small features; where it stops to, there is noise, or detail that cannot be told from it as it
/// is no wider than the edges.
///
/// From the smallest features up, the bands belong to the floor as long as each would need no more
/// than 1.6 times the height that explains all smaller ones together. The smallest bands that hold
/// 5 % of the noise are taken as they are; if the next one fails there is no floor.
///
/// The height of the floor is that of its bands without the last one, which has the most relief;
/// what the others have makes it up to 20 % too large. Noise higher than about a quarter of the
/// edges folds the surface and changes its harmonics: it is found, but too low and at too small
/// features.
///
/// @param featureSize  of the bands, a third of an octave each, length units, descending.
/// @param amplitude    root mean square height of the shape in each, length units.
/// @param noise        that of noise of height 1 in each, > 0.
NoiseFloor noiseFloor(const Eigen::VectorXd& featureSize, const Eigen::VectorXd& amplitude,
                      const Eigen::VectorXd& noise);

}  // namespace spectral
