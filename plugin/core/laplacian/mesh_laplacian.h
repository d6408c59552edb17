#pragma once

#include "core/laplacian/constant_modes.h"
#include "core/laplacian/laplacian.h"
#include "core/laplacian/laplacian_builder.h"
#include "core/mesh/components.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
#include "core/support/types.h"

namespace spectral {

/// The Laplacian of a mesh as it stands, with all that an evaluation on this one shape needs.
struct MeshLaplacian {
    Surface surface;  ///< Its rows are those of W and D.
    Components components;
    Laplacian laplacian;
    ConstantModes constants;
};

/// @param V  n x 3 positions, finite; unreferenced vertices allowed.
/// @param F  m x 3 vertex indices, m >= 1; any topology.
/// @throws InvalidMesh  as checkMesh; SolverFailure when a cotangent or a mass is not finite.
MeshLaplacian meshLaplacian(const Vertices& V, const Faces& F, LaplacianKind kind);

/// Values of the surface's vertices (rows of `values`) at the rows of the mesh; 0 at unreferenced
/// vertices.
///
/// @param vertexCount  n of the mesh that the surface was taken from.
Eigen::MatrixXd onMesh(const Surface& surface, Eigen::MatrixXd values, Index vertexCount);

}  // namespace spectral
