#pragma once

#include <vector>

#include "core/graph/face_graph.h"

namespace spectral {

/// Standard deviation along the normals of the white noise under a shape that may be as high.
///
/// White noise has the same height through every filter, a shape does not: of all combinations of
/// (I - P) P^j, j from 0 to 5, takes the one through which the mesh is lowest relative to white
/// noise, and measures in the quiet quarter of the places, as noise is the same in all of them.
/// Waves at any few frequencies vanish so, and steps as well where they repeat.
/// @param X           n x 3 positions.
/// @param N           n x 3 smoothVertexNormals.
/// @param isMeasured  n: whether a vertex counts.
/// @param highest     height measured otherwise, length units, > 0: the result is at most this, and
///                    is this where all filters are alike, as on tetrahedra.
/// @return  length units.
double leastHeight(const FaceGraph& graph, const Points& X, const Points& N,
                   const std::vector<bool>& isMeasured, double highest);

}  // namespace spectral
