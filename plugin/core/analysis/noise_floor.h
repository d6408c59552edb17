#pragma once

#include <Eigen/Core>

namespace spectral {

/// The feature size below which a shape has more noise than relief, given the height of its noise.
///
/// Independent noise at the vertices, of equal root mean square height across the surface, has a
/// known share of its energy in each band of a mesh. So the height of noise that would explain a
/// band is amplitude / noise. From the smallest features up, a band is noise as long as that is at
/// most 1.6 times the height: relief as high as the noise makes it 1.4 times, and bands of few
/// harmonics scatter.
///
/// @param height       root mean square height of the noise, length units; 0: none.
/// @param featureSize  feature sizes of the bands, third octaves, length units, descending.
/// @param amplitude    root mean square height of the shape in each band, length units.
/// @param noise        the same for noise of height 1, > 0.
/// @return  length units; 0 if no band is noise.
double noiseFeatureSize(double height, const Eigen::VectorXd& featureSize,
                        const Eigen::VectorXd& amplitude, const Eigen::VectorXd& noise);

}  // namespace spectral
