#pragma once

#include "core/denoise/face_graph.h"
#include "core/mesh/mesh.h"

namespace spectral {

/// Turns faces back that point against their filtered normals: noise along the surface has folded
/// them, and vertices that move along normals alone cannot undo that. Their corners, and no other
/// vertices, move within the surface to the mean of their neighbours, unless that is farther than
/// the noise can have moved them, as among needles.
///
/// @param N        m x 3 filtered normals.
/// @param farthest  of a move, length units.
/// @param isFixed  n: vertices that stay.
/// @param X        n x 3 positions, moved.
void unfoldFaces(const FaceGraph& graph, const Normals& N, double farthest,
                 const std::vector<bool>& isFixed, Vertices& X);

}  // namespace spectral
