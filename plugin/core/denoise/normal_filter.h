#pragma once

#include "core/mesh/mesh.h"
#include "core/noise/face_graph.h"

namespace spectral {

struct NormalFilterOptions {
    double time = 0.0;       ///< t, >= 0.
    double edgeScale = 0.0;  ///< s: distance of unit normals from which they hardly mix, > 0.
    double height = 0.0;     ///< Of the noise, mean edges.
    int blurs = 2;           ///< Of the normals that the weights are taken from, >= 0.
    bool isTwice = false;    ///< F + F (1 - F) instead of F: flatter where the shape is.
};

/// The normals of the shape X (n x 3), smoothed over the faces but not across creases:
///
///     N' = F N,  F = (M + t L)^-1 M,  scaled to length 1,
///
/// L the Laplacian of the face graph with the weights |e| / mean |e| exp(-|q_a - q_b|^2 / (2 s^2))
/// between faces a and b with the common edge e, q the normals blurred over the neighbours; M
/// the roots of the areas over the mean area, as the normal of a small face is the less certain. L
/// is thus taken from the shape as it is: one weak part of a fractional filter (Kovnatsky et al.
/// 2012, Eq. 11) whose signal is the field of normals. Where edges are short, noise tilts faces the
/// more: s^2 grows there by what the height of the noise explains.
///
/// Applied once more to what it has taken away (Tukey's twicing, 1977), F passes twice as much of
/// the low frequencies' detail and as good as nothing more of the high ones.
///
/// @param guess  m x 3 normals near the result, such as those of the part before; or none.
Points filterNormals(const FaceGraph& graph, const Points& X, const NormalFilterOptions& options,
                     const Points& guess = {});

}  // namespace spectral
