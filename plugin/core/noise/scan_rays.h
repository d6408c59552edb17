#pragma once

#include <vector>

#include "core/graph/face_graph.h"

namespace spectral {

/// The lines that the noise of a single scan lies along.
struct ScanRays {
    Points direction;        ///< n x 3 unit vectors; no rows: this is no single scan.
    bool arePixels = false;  ///< Whether the vertices are the pixels of a depth camera.
};

/// The rays of a scanner whose noise has been found on the surface.
///
/// From the eye, if a camera there has seen the surface (open, every face turned towards it, all of
/// it on one side) and its vertices are on a lattice of pixels or of depths. Otherwise the first
/// principal direction of what alternates, parallel for all vertices, where it is 3 times as high
/// as the second and all faces are seen along it. Without one, noise correlated over several edges
/// that is seen from the eye is that of pixels, too.
///
/// @param eye           the origin of the file's coordinates.
/// @param isMeasured    n: whether a vertex counts.
/// @param isCorrelated  whether the noise is correlated over several edges.
ScanRays scanRays(const Eigen::RowVector3d& eye, const FaceGraph& graph, const Points& X,
                  const std::vector<bool>& isMeasured, bool isCorrelated);

}  // namespace spectral
