#pragma once

#include <vector>

#include "core/mesh/mesh.h"

namespace spectral {

/// Whether each vertex is on a crease: an edge of two triangles whose planes differ by more than an
/// angle, however they are oriented.
///
/// @param X      n x 3.
/// @param F      m x 3 indices into X.
/// @param angle  between the planes: 0 for a flat edge, 90 for that of a cube, degrees.
std::vector<bool> creaseVertices(const Vertices& X, const Faces& F, double angle);

}  // namespace spectral
