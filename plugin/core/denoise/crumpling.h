#pragma once

#include "core/noise/face_graph.h"

namespace spectral {

/// Whether a filter has crumpled a surface instead of smoothing it: it has folded more than a
/// hundredth of the edges over, or moved two fifths of the vertices farther than their triangles
/// are high.
///
/// Wherever noise was removed from scans, at most 0.003 and 0.3 were seen; on CAD tessellations
/// with a height that does not fit them 0.03 and more, or 0.6 and more.
/// @param X0, X  n x 3 positions before and after.
bool isCrumpled(const FaceGraph& graph, const Points& X0, const Points& X);

}  // namespace spectral
