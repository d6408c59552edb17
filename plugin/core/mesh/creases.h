#pragma once

#include <vector>

#include "core/mesh/mesh.h"

namespace spectral {

/// Whether each vertex is on a crease: an edge between two triangles whose planes differ by more
/// than `angle`, whatever their orientation.
///
/// @param X      n x 3 positions.
/// @param F      m x 3 indices into X.
/// @param angle  angle between the planes in degrees: 0 at a flat edge, 90 on a cube.
/// @return       n flags.
std::vector<bool> creaseVertices(const Vertices& X, const Faces& F, double angle);

}  // namespace spectral
