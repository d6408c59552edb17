#pragma once

#include <vector>

#include "core/noise/face_graph.h"

namespace spectral {

/// Turns faces back that point against their filtered normals: noise along the surface has folded
/// them, and vertices that move along normals alone cannot undo that. Their corners, and no other
/// vertices, move within the surface to the mean of their neighbours, unless that is farther than
/// the noise can have moved them, as among needles.
///
/// @param N         m x 3 filtered normals.
/// @param farthest  of a move, length units.
/// @param mayMove   n
/// @param X         n x 3 positions, moved.
void unfoldFaces(const FaceGraph& graph, const Points& N, double farthest,
                 const std::vector<bool>& mayMove, Points& X);

}  // namespace spectral
