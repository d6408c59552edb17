#pragma once

#include "core/mesh/mesh.h"

namespace spectral {

/// Rejects a mesh without a Laplacian.
///
/// @throws InvalidMesh  when there are no vertices or no triangles, an index is out of range, a
///                      coordinate is not finite, or no triangle has a positive area.
void checkMesh(const Vertices& V, const Faces& F);

/// Whether the area of triangle t vanishes relative to its longest edge.
bool isDegenerate(const Vertices& V, const Faces& F, Index t);

/// Rejects a mesh with infinite cotangents.
///
/// @throws InvalidMesh  when a triangle is degenerate: its area vanishes relative to its longest
///                      edge.
void checkAreas(const Vertices& V, const Faces& F);

}  // namespace spectral
