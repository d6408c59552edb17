#pragma once

#include "core/mesh/mesh.h"

namespace spectral {

/// Diagonal of the axis-aligned bounding box.
double boundingBoxDiagonal(const Vertices& V);

/// Mean side length over all triangles, which counts interior edges twice; 0 without triangles.
double meanEdgeLength(const Vertices& V, const Faces& F);

/// Total area of the triangles.
double surfaceArea(const Vertices& V, const Faces& F);

/// Signed volume by the divergence theorem, positive for outward orientation. For an open surface,
/// that of its cone over the centre of the bounding box.
double signedVolume(const Vertices& V, const Faces& F);

/// Whether the triangles' areas, as vectors along their normals, sum to zero, to round-off: the
/// signed volume then has no need of the centre. So it is with surfaces that are closed and
/// consistently oriented.
bool enclosesVolume(const Vertices& V, const Faces& F);

}  // namespace spectral
