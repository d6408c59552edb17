#pragma once

#include <vector>

#include "core/denoise/face_graph.h"
#include "core/mesh/mesh.h"

namespace spectral {

/// Noise that is independent at every vertex.
struct NoiseEstimate {
    double height = 0.0;    ///< Standard deviation along the normals, length units; 0: none seen.
    double meanEdge = 0.0;  ///< Mean edge length without the noise, length units.
};

/// Estimates the height of the noise from the highest frequencies of the uniform Laplacian
/// L = I - (mean of the neighbours), in which independent noise has the same energy everywhere
/// while that of a shape falls towards high frequencies.
///
/// The normal parts of L X and of L^2 X, each divided by what noise of height 1 would be there, are
/// equal where there is noise alone; the shape adds to the former more than to the latter. Medians
/// over the vertices leave creases and single outliers out. Fewer than a hundred vertices do not
/// tell.
/// @param X  n x 3 positions.
NoiseEstimate estimateNoise(const FaceGraph& graph, const Vertices& X);

/// The standard deviation of normally distributed values, by the median of their moduli, which it
/// reorders; 0 for none.
double medianDeviation(std::vector<double>& moduli);

}  // namespace spectral
