#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/mesh/mesh.h"

namespace spectral {

/// The part of a mesh that a Laplacian is defined on.
struct Surface {
    /// A vertex of the mesh that is one with another, see seams.h.
    struct Copy {
        Index vertex;  ///< Row in the mesh.
        Index row;     ///< Row of X.
    };

    Vertices X;  ///< n x 3, centred at the bounding box: no digits are lost far from the origin.
    Faces F;     ///< m x 3, indices into X; the corners of a triangle differ.
    std::vector<Index> vertex;   ///< Row in the mesh of each row of X, ascending.
    std::vector<Copy> copies{};  ///< Vertices of the mesh that are one with those, ascending.
    int nearlyCopies = 0;        ///< Vertices at a distance of round-off from being copies.
};

/// The triangles with three different corners, and their vertices, renumbered. Unreferenced
/// vertices are left out.
Surface surfaceOf(const Vertices& V, const Faces& F);

/// The same, with vertices at seams as one: each row of X is the first of them in the mesh, the
/// others are its copies.
Surface joinedSurface(const Vertices& V, const Faces& F);

/// Values at the vertices of a mesh as values on its surface: at a seam their mean.
/// @param values  one row for each vertex of the mesh.
Eigen::MatrixXd restricted(const Eigen::MatrixXd& values, const Surface& surface);

/// Values on a surface as values at the n vertices of its mesh: zero beyond the surface.
Eigen::MatrixXd extended(Eigen::MatrixXd values, const Surface& surface, Index n);

/// Adds what changes on a surface to the values of its mesh. At a seam all copies get the same
/// value; one whose change is zero keeps its bits, the sign of a zero included.
Eigen::MatrixXd changed(const Eigen::MatrixXd& values, const Surface& surface,
                        const Eigen::MatrixXd& change);

/// Extends values at some of n vertices by zero: row i of `values` (m x c) becomes row vertex[i] of
/// the result (n x c).
Eigen::MatrixXd extendedByZero(Eigen::MatrixXd values, const std::vector<Index>& vertex, Index n);

/// What a surface is made of.
struct SurfaceCounts {
    int components = 0;            ///< Connected components.
    int unreferencedVertices = 0;  ///< Vertices of no triangle, unchanged.
    int joinedVertices = 0;        ///< Vertices of the mesh that are one with another (seams.h).
    int nearlyJoined = 0;          ///< Vertices at a distance of round-off from being that.
    int fixedVertices = 0;         ///< Vertices of the surface that must not move.
};

/// @param n      number of vertices of the mesh.
/// @param fixed  number of vertices of the surface that must not move.
SurfaceCounts countsOf(const Surface& surface, Index n, int components, Index fixed);

/// The connected components of a surface: triangles that share a vertex are connected.
struct Components {
    Eigen::VectorXi label;  ///< n labels, 0 <= label < count; -1 at vertices of no component.
    int count = 0;
};

/// @param F  m x 3 indices in [0, vertexCount); every vertex is in some triangle.
Components connectedComponents(const Faces& F, Index vertexCount);

}  // namespace spectral
