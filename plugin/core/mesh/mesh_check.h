#pragma once

#include "core/laplacian/laplacian_builder.h"
#include "core/mesh/mesh.h"
#include "core/support/types.h"

namespace spectral {

/// Refuses what no Laplacian can be made of.
///
/// @throws InvalidMesh  when there is no vertex or no triangle, an index is out of range, a
///                      coordinate is not finite, or no triangle has an area; with
///                      LaplacianKind::Cotangent also when some triangle is degenerate (two equal
///                      corners, or an area that is zero beside its longest edge). The text counts
///                      them and names the MeshLab filter that mends it.
void checkMesh(const Vertices& V, const Faces& F, LaplacianKind kind);

}  // namespace spectral
