#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/mesh/mesh.h"

namespace spectral {

/// How far away heights are still alike: the spatial parameters of ISO 25178-2.
struct TextureLengths {
    double Sal = 0.0;  ///< Shortest lag at which the autocorrelation falls to .2, length; 0: none.
    double Str = 0.0;  ///< Sal over the longest one of the central peak, 0 to 1; 0: none.
};

/// Of heights on a regular grid, such as a height map: one vertex a cell, more than half of the
/// cells, in two of the three coordinates. None otherwise, for an autocorrelation needs lags.
///
/// Sums over pairs of vertices at a lag are divided by the number of these pairs, after the mean
/// height is taken off. Lags reach to half of the map: where the peak does, in the direction of
/// grooves for instance, there is no Str.
///
/// @param h          n heights, length units.
/// @param points     n x 3 positions, of which two coordinates may be those of a grid.
/// @param reference  n x 3 positions without roughness: lags are measured along them.
/// @param counts     n, whether each vertex is evaluated.
TextureLengths textureLengths(const Eigen::VectorXd& h, const Vertices& points,
                              const Vertices& reference, const std::vector<bool>& counts);

}  // namespace spectral
