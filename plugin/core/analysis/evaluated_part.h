#pragma once

#include <array>
#include <vector>

#include "core/laplacian/laplacian.h"
#include "core/mesh/surface.h"

namespace spectral {

/// Two vertices that an edge joins.
using EdgeVertices = std::array<Index, 2>;

/// The boundary of a surface: where it ends, and the holes where points are missing.
struct Outline {
    std::vector<EdgeVertices> ends;
    std::vector<EdgeVertices> holes;  ///< Edges as their triangle has them.
    std::vector<int> hole;            ///< For each of `holes`, 0 <= hole < count.
    int count = 0;
};

/// A boundary loop encloses a hole if the surface turns around it: its exterior angles sum to
/// -2 pi, those of the end of a tube to 0, of an outer rim to 2 pi.
///
/// @param largestHole  diagonal of the bounding box of the largest hole, length units.
Outline outlineOf(const Surface& surface, double largestHole);

/// The surface with a fan over each hole, around the mean of its rim. Rows of X and `vertex` are
/// appended, one for each hole, with a vertex of its rim; triangles, one for each edge.
Surface bridged(Surface surface, const Outline& outline);

/// Values at the vertices of a surface, and the means over the rims of its holes, appended.
Eigen::MatrixXd bridged(const Eigen::MatrixXd& values, const Outline& outline);

/// Whether each vertex is further than a distance from some edges: within it, a low-pass averages
/// over what is not there, or over both sides of a crease.
///
/// The distance is the straight one to the nearest such edge, along vertices that are within it.
///
/// @param W         whose pattern tells the neighbours, n x n.
/// @param distance  length units; 0: all vertices.
/// @return          n flags.
std::vector<bool> farFrom(const std::vector<EdgeVertices>& edges, const Surface& surface,
                          const SparseMatrix& W, double distance);

}  // namespace spectral
