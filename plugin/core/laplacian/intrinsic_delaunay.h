#pragma once

#include <vector>

#include "core/laplacian/intrinsic_triangulation.h"
#include "core/mesh/mesh.h"
#include "core/support/types.h"

namespace spectral {

/// The cotangent matrix on the intrinsic Delaunay triangulation of a mesh of any topology.
///
/// N. Sharp and K. Crane, "A Laplacian for Nonmanifold Triangle Meshes", SGP 2020: the edge lengths
/// are mollified, so that no triangle is degenerate; the triangles are glued into a closed surface,
/// the tufted cover; its edges are flipped, by lengths alone, until all are Delaunay; the cotangent
/// matrix of that triangulation is taken. All weights are then non-negative and W is positive
/// semidefinite, whatever the triangles were: boundaries, edges with many triangles, duplicate and
/// zero-area faces are allowed.
///
/// The gluing depends on the connectivity only (and, round an edge of more than two triangles, on
/// their order in the first embedding): it is made once for all steps of a filter.
class IntrinsicDelaunay {
  public:
    /// @param V  n x 3, gives the order of the triangles round non-manifold edges.
    /// @param F  m x 3; three different corners each, every vertex in some triangle.
    IntrinsicDelaunay(const Vertices& V, const Faces& F);

    /// The Delaunay triangulation of the tufted cover of the embedding V (n x 3, finite, not all in
    /// one point).
    /// @throws SolverFailure  when the flips do not end.
    IntrinsicTriangulation triangulation(const Vertices& V) const;

    /// W of the embedding V: n x n, symmetric, rows sum to 0.
    /// @throws SolverFailure  when the flips do not end.
    SparseMatrix stiffness(const Vertices& V) const;

    /// Whether the cover has one copy of every triangle, which is enough for a closed, oriented
    /// surface, or a front and a back.
    bool isSingleCover() const { return copies_ == 1; }

  private:
    Index vertexCount_;
    int copies_;  // of every triangle in the cover: 1 or 2
    std::vector<int>
        tail_;  // vertex where a side begins; sides 3 t, 3 t + 1, 3 t + 2 of triangle t
    std::vector<int> twin_;     // side glued to a side; it runs the other way
    std::vector<int> oneSide_;  // of every edge of the mesh
};

}  // namespace spectral
