#pragma once

#include "core/denoise/face_graph.h"
#include "core/mesh/mesh.h"

namespace spectral {

struct NormalFilterOptions {
    double time = 0.0;       ///< t, >= 0.
    double edgeScale = 0.0;  ///< s: distance of unit normals from which they hardly mix, > 0.
};

/// The normals of the shape X (n x 3), smoothed over the faces but not across creases:
///
///     N' = (M + t L)^-1 M N, scaled to length 1,
///
/// L the Laplacian of the face graph with the weights |e| / mean |e| exp(-|q_a - q_b|^2 / (2 s^2))
/// between faces a and b with the common edge e, q the normals blurred over the neighbours; M
/// the roots of the areas over the mean area, as the normal of a small face is the less certain. L
/// is thus taken from the shape as it is: one weak part of a fractional filter (Kovnatsky et al.
/// 2012, Eq. 11) whose signal is the field of normals.
/// @throws SolverFailure
Normals filterNormals(const FaceGraph& graph, const Vertices& X,
                      const NormalFilterOptions& options);

}  // namespace spectral
