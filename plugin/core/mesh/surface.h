#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/mesh/mesh.h"

namespace spectral {

/// The part of a mesh that a Laplacian is defined on.
struct Surface {
    Vertices X;  ///< n x 3, centred at the bounding box: no digits are lost far from the origin.
    Faces F;     ///< m x 3, indices into X; the corners of a triangle differ.
    std::vector<Index> vertex;  ///< Row in the mesh of each row of X, ascending.
};

/// The triangles with three different corners, and their vertices, renumbered. Unreferenced
/// vertices are left out.
Surface surfaceOf(const Vertices& V, const Faces& F);

/// Extends values at some of n vertices by zero: row i of `values` (m x c) becomes row vertex[i] of
/// the result (n x c).
Eigen::MatrixXd extendedByZero(Eigen::MatrixXd values, const std::vector<Index>& vertex, Index n);

/// The connected components of a surface: triangles that share a vertex are connected.
struct Components {
    Eigen::VectorXi label;  ///< n labels, 0 <= label < count; -1 at vertices of no component.
    int count = 0;
};

/// @param F  m x 3 indices in [0, vertexCount); every vertex is in some triangle.
Components connectedComponents(const Faces& F, Index vertexCount);

}  // namespace spectral
