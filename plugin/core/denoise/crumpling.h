#pragma once

#include "core/graph/face_graph.h"

namespace spectral {

/// Whether a filter has crumpled a surface instead of smoothing it: it has folded more than 1 % of
/// the edges, or moved more than 40 % of the vertices farther than their triangles are high. Both
/// limits are well above what removing noise takes, and well below what happens to a CAD
/// tessellation when the noise height is too large for it.
/// @param X0, X  n x 3 positions before and after.
bool isCrumpled(const FaceGraph& graph, const Points& X0, const Points& X);

}  // namespace spectral
