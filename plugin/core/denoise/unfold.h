#pragma once

#include <vector>

#include "core/graph/face_graph.h"

namespace spectral {

/// Unfolds faces that point away from their filtered normals: noise along the surface has folded
/// them, which displacements along normals cannot undo. Only their corners move, within the surface
/// to the mean of their neighbours, unless noise cannot have moved them that far, as among needle
/// triangles.
///
/// @param N                m x 3 filtered normals.
/// @param maxDisplacement  n: largest displacement, length units.
/// @param mayMove          n: whether a vertex may move.
/// @param X                n x 3 positions, updated.
void unfoldFaces(const FaceGraph& graph, const Points& N, const Eigen::VectorXd& maxDisplacement,
                 const std::vector<bool>& mayMove, Points& X);

}  // namespace spectral
