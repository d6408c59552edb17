#pragma once

#include <vector>

#include "core/laplacian/laplacian.h"
#include "core/mesh/surface.h"

namespace spectral {

/// Whether each vertex is further than a distance from boundaries and sharp creases: within it, a
/// low-pass averages over what is not there, or over both sides of the crease.
///
/// The distance is the straight one to the nearest such edge, along vertices that are within it.
///
/// @param W            whose pattern tells the neighbours, n x n.
/// @param creaseAngle  angle between the planes of two faces, degrees; 180: no edge is a crease.
/// @param distance     length units; 0: all vertices.
/// @return             n flags.
std::vector<bool> farFromEnds(const Surface& surface, const SparseMatrix& W, double creaseAngle,
                              double distance);

}  // namespace spectral
