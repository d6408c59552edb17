#pragma once

#include "core/mesh/mesh.h"
#include "core/support/types.h"

namespace spectral {

/// Length of the diagonal of the axis-parallel bounding box.
double boundingBoxDiagonal(const Vertices& V);

/// Mean length of the triangles' sides: about that of the edges, most of which are two sides. 0
/// without triangles.
double meanEdgeLength(const Vertices& V, const Faces& F);

/// Area of all triangles.
double surfaceArea(const Vertices& V, const Faces& F);

/// Signed volume by the divergence theorem, positive for outward orientation. A volume only where
/// the surface is closed; taken about the middle of the bounding box otherwise.
double signedVolume(const Vertices& V, const Faces& F);

}  // namespace spectral
