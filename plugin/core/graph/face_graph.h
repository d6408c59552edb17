#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/mesh/mesh.h"
#include "core/support/types.h"

namespace spectral {

/// Positions or normals, n x 3; row-major, because sweeps gather rows.
using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// The neighbours of every vertex, ascending: the vertices it shares an edge with.
struct VertexGraph {
    std::vector<Index> first;      ///< n + 1: vertex i has neighbours first[i] to first[i + 1] - 1.
    std::vector<int> at;           ///< The neighbours of all vertices.
    std::vector<double> weight{};  ///< Their shares in means, which sum to 1; empty: all alike.

    Index size() const { return static_cast<Index>(first.size()) - 1; }
    Index degree(Index i) const { return first[i + 1] - first[i]; }
};

/// The faces of a surface as a graph, the dual of its mesh: neighbours share an edge that no other
/// face has.
struct FaceGraph {
    Faces F;           ///< m x 3: consistently oriented, unless the surface is not orientable.
    Faces neighbours;  ///< m x 3: the face across the side opposite each corner; -1 at a rim.
    std::vector<bool> onRim;  ///< n: whether at an edge of one face, or of more than two.
    VertexGraph faces;        ///< The faces at every vertex.
    VertexGraph vertices;     ///< The neighbours of every vertex.

    Index vertexCount() const { return static_cast<Index>(onRim.size()); }
    Index faceCount() const { return F.rows(); }
};

/// The faces without those that have the same corners as an earlier one, whatever their order: a
/// surface whose faces have two sides each is one surface.
Faces distinctFaces(const Faces& F, Index vertexCount);

/// @param F  m x 3 indices in [0, vertexCount), as in Surface.
FaceGraph faceGraph(const Faces& F, Index vertexCount);

/// The same graph, with weights 1 / length^power.
/// @param X  n x 3 positions.
VertexGraph weightedByLength(VertexGraph graph, const Points& X, double power);

/// Face normals (m x 3) of the shape X (n x 3), with length twice the area.
Points areaNormals(const Points& X, const Faces& F);

/// Adds to each normal those of the neighbouring faces, `times` times.
/// @param N  area-weighted normals as from areaNormals.
Points blurredNormals(const FaceGraph& graph, Points N, int times);

/// Unit vertex normals, n x 3: the normalized sums of the normals N (m x 3) of their faces.
Points vertexNormals(const FaceGraph& graph, const Points& N);

constexpr double kNeedleQuality = 0.6;

/// 4 sqrt(3) area / (sum of squared sides) of each face: 1 for equilateral triangles.
/// Surfaces of needles, as of CAD programs, have a median below kNeedleQuality.
std::vector<double> triangleQuality(const Faces& F, const Points& X);

/// Scales each row to length 1; zero rows stay zero.
void normalizeRows(Points& N);

}  // namespace spectral
