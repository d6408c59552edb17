#pragma once

#include <vector>

#include "core/graph/face_graph.h"

namespace spectral {

/// Moves the vertices to make the faces match given normals as far as possible:
///
///     x_i <- x_i + sum_{f in F_i} n_f n_f^T (c_f - x_i) / |F_i|,
///
/// where c_f is the centroid of face f (Sun, Rosin, Martin, Langbein 2007, Eq. 14). Vertices move
/// only along normals, so that triangles do not drift within the surface.
///
/// @param X        n x 3 positions.
/// @param N        m x 3 unit normals.
/// @param mayMove  n: whether a vertex may move.
/// @param sweeps   number of iterations, >= 1; summed as a polynomial of lower degree, to 3e-4.
/// @return         n x 3 positions.
Points followNormals(const FaceGraph& graph, const Points& X, const Points& N,
                     const std::vector<bool>& mayMove, int sweeps);

/// The same, but vertices move along given lines only, such as the rays of a camera, on which its
/// noise lies.
/// @param D  n x 3 unit directions.
Points followNormalsAlong(const FaceGraph& graph, const Points& X, const Points& N, const Points& D,
                          const std::vector<bool>& mayMove, int sweeps);

}  // namespace spectral
