#pragma once

#include <vector>

#include "core/mesh/mesh.h"

namespace spectral {

/// Whether each vertex lies on the boundary: is an end point of an edge of exactly one triangle.
///
/// @param F  m x 3 indices in [0, vertexCount).
std::vector<bool> boundaryVertices(const Faces& F, Index vertexCount);

}  // namespace spectral
