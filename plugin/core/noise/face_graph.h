#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/mesh/mesh.h"
#include "core/support/types.h"

namespace spectral {

/// Positions or normals, n x 3; the rows are contiguous, as sweeps gather them.
using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// The neighbours of every vertex, ascending: the vertices it shares an edge with.
struct VertexGraph {
    std::vector<Index> first;  ///< n + 1: of vertex i from first[i] to first[i + 1] - 1
    std::vector<int> at;       ///< neighbours

    Index size() const { return static_cast<Index>(first.size()) - 1; }
    Index degree(Index i) const { return first[i + 1] - first[i]; }
};

/// The faces of a surface as a graph, the dual of its mesh: neighbours share an edge that no other
/// face has.
struct FaceGraph {
    Faces F;           ///< m x 3: neighbours are oriented alike, but where there is one side only.
    Faces neighbours;  ///< m x 3: the face beyond the side opposite to each corner; -1: a rim.
    std::vector<bool> onRim;  ///< n: at an edge of one face, or of more than two.
    VertexGraph faces;        ///< The faces at every vertex, instead of its neighbours.
    VertexGraph vertices;

    Index vertexCount() const { return static_cast<Index>(onRim.size()); }
    Index faceCount() const { return F.rows(); }
};

/// @param F  m x 3 indices in [0, vertexCount), as in Surface.
FaceGraph faceGraph(const Faces& F, Index vertexCount);

/// Normals of the faces of the shape X (n x 3), m x 3, of length twice the area.
Points areaNormals(const Points& X, const Faces& F);

/// Adds the normals of the neighbours of its face to each normal, `times` over.
/// @param N  as from areaNormals: large faces count for more.
Points blurredNormals(const FaceGraph& graph, Points N, int times);

/// Unit normals of the vertices, n x 3: the sums of the normals N (m x 3) of their faces.
Points vertexNormals(const FaceGraph& graph, const Points& N);

/// Scales each row to length 1; zeros stay.
void normalizeRows(Points& N);

}  // namespace spectral
