#pragma once

#include <vector>

#include "core/noise/face_graph.h"

namespace spectral {

/// Moves the vertices until the faces have the normals, as far as that is possible:
///
///     x_i <- x_i + 1/|F_i| sum_{f in F_i} n_f n_f^T (c_f - x_i),
///
/// c_f the centroid of face f (Sun, Rosin, Martin, Langbein 2007, Eq. 14). Vertices move along
/// normals alone, so that the triangles do not drift within the surface.
///
/// @param X       n x 3 positions.
/// @param N       m x 3 unit normals.
/// @param mayMove n
/// @param sweeps  how often, >= 0.
Points followNormals(const FaceGraph& graph, Points X, const Points& N,
                     const std::vector<bool>& mayMove, int sweeps);

}  // namespace spectral
