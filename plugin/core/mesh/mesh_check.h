#pragma once

#include "core/mesh/mesh.h"

namespace spectral {

/// Rejects a mesh that no Laplacian exists for.
///
/// @throws InvalidMesh  without vertices or triangles, with an index out of range, a coordinate
///                      that is not finite, or no triangle of positive area.
void checkMesh(const Vertices& V, const Faces& F);

/// Rejects a mesh with infinite cotangents.
///
/// @throws InvalidMesh  when a triangle is degenerate: its area vanishes relative to its longest
///                      edge.
void checkAreas(const Vertices& V, const Faces& F);

}  // namespace spectral
