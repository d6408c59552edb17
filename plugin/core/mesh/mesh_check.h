#pragma once

#include "core/mesh/mesh.h"

namespace spectral {

/// Refuses a mesh that has no Laplacian of any kind.
///
/// @throws InvalidMesh  without a vertex or a triangle, with an index out of range, a coordinate
///                      that is not finite, or no triangle with an area.
void checkMesh(const Vertices& V, const Faces& F);

/// Refuses a mesh whose cotangents are not all finite.
///
/// @throws InvalidMesh  when a triangle is degenerate: two equal corners, or no area compared with
///                      its longest edge.
void checkAreas(const Vertices& V, const Faces& F);

}  // namespace spectral
