#pragma once

#include <vector>

#include "core/laplacian/intrinsic_triangulation.h"
#include "core/mesh/mesh.h"
#include "core/mesh/sides.h"

namespace spectral {

/// The cotangent matrix on the intrinsic Delaunay triangulation of a mesh of any topology.
///
/// N. Sharp and K. Crane, "A Laplacian for Nonmanifold Triangle Meshes", SGP 2020. The edge lengths
/// are mollified, so that no triangle is degenerate; the triangles are glued into a closed surface,
/// the tufted cover; intrinsic flips make it Delaunay. W, its cotangent matrix, has non-negative
/// weights and is positive semidefinite for any triangles: boundaries, non-manifold edges,
/// duplicate and zero-area faces are allowed.
///
/// The gluing depends only on connectivity, except around non-manifold edges, where it depends on
/// the first embedding. It is computed once for all steps of a filter.
class IntrinsicDelaunay {
  public:
    /// @param V  n x 3 positions, used to sort the triangles around non-manifold edges.
    /// @param F  m x 3; the corners of a triangle are distinct, every vertex is in some triangle.
    IntrinsicDelaunay(const Vertices& V, const Faces& F)
        : IntrinsicDelaunay(V, F, SidesByEdge(F)) {}
    IntrinsicDelaunay(const Vertices& V, const Faces& F, const SidesByEdge& edges);

    /// Delaunay triangulation of the tufted cover, which has one copy of every triangle if the
    /// surface is closed and oriented, else a front and a back.
    /// @param V  n x 3, finite, not all at one point.
    IntrinsicTriangulation triangulation(const Vertices& V) const& {
        return IntrinsicDelaunay(*this).triangulation(V);
    }
    IntrinsicTriangulation triangulation(const Vertices& V) &&;  ///< Without copies of the gluing.

    /// W of the embedding V: n x n, symmetric, rows sum to 0; same requirements.
    SparseMatrix stiffness(const Vertices& V) const& {
        return IntrinsicDelaunay(*this).stiffness(V);
    }
    SparseMatrix stiffness(const Vertices& V) &&;

  private:
    Index vertexCount_;
    int copies_;               // copies of every triangle in the cover: 1 or 2
    std::vector<int> tail_;    // first vertex of each side, see IntrinsicTriangulation
    std::vector<int> twin_;    // side glued to each side
    std::vector<char> first_;  // of each side of F, whether it is the first of its edge, or 0
};

}  // namespace spectral
