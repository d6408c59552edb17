#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/mesh/mesh.h"
#include "core/support/types.h"

namespace spectral {

/// The faces of a surface as a graph, the dual of its mesh: neighbours share an edge that no other
/// face has.
struct FaceGraph {
    struct Edge {
        int faces[2];
        int ends[2];  ///< The vertices of the shared edge.
    };

    Faces F;  ///< m x 3: neighbours are oriented alike, but where the surface has one side only.
    std::vector<Edge> edges;
    std::vector<bool> onRim;  ///< n: at an edge of one face, or of more than two.

    // The faces at vertex i: faceAt[firstFace[i]] to faceAt[firstFace[i + 1] - 1], ascending.
    std::vector<Index> firstFace;  ///< n + 1
    std::vector<int> faceAt;       ///< 3 m

    Index vertexCount() const { return static_cast<Index>(onRim.size()); }
    Index faceCount() const { return F.rows(); }
};

/// @param F  m x 3 indices in [0, vertexCount), as in Surface.
FaceGraph faceGraph(const Faces& F, Index vertexCount);

using Normals = Vertices;  ///< Rows of length 1, or 0 at a face without area.

/// Normals of the faces of the shape X (n x 3), m x 3, of length twice the area.
Vertices areaNormals(const Vertices& X, const Faces& F);

/// The same, of length 1.
Normals faceNormals(const Vertices& X, const Faces& F);

/// Adds the normals of the neighbours of its face to each normal, `times` over.
/// @param N  as from areaNormals: large faces count for more.
Vertices blurredNormals(const FaceGraph& graph, Vertices N, int times);

/// Scales each row to length 1; zeros stay.
void normalizeRows(Normals& N);

}  // namespace spectral
