#pragma once

#include "core/laplacian/constant_modes.h"
#include "core/mesh/mesh.h"

namespace spectral {

/// The Laplace-Beltrami operator A = D^-1 W of a triangle mesh, as the generalized eigenproblem
/// W phi = lambda D phi (Kovnatsky et al. 2012, Eq. 4), and its null space.
///
/// Sign: W is positive semidefinite, lambda >= 0 (the paper writes Delta = -div grad).
/// A frequency is omega = sqrt(lambda), in radians per length unit; its wavelength is 2 pi / omega.
struct Laplacian {
    SparseMatrix W;     ///< Stiffness (cotangent) matrix, n x n, symmetric, both triangles stored,
                        ///< dimensionless; natural (Neumann) boundary conditions.
    Eigen::VectorXd D;  ///< Lumped mass matrix, n diagonal entries > 0, length units squared.
    ConstantModes constants{};  ///< One constant function per component, D-weighted.
};

/// W_ij = -(cot a_ij + cot b_ij)/2, W_ii = -sum_j W_ij. A triangle of zero area gives entries that
/// are not finite; see `isUsable`.
/// @param F  every vertex is in some triangle.
SparseMatrix cotangentStiffness(const Vertices& V, const Faces& F);

/// W as if all triangles were equilateral: W_ij = -1/sqrt(3) (half of that on a boundary). With
/// D_ii the mean vertex area, frequencies are those of the surface where the sampling is even.
/// Noise that is independent at every vertex then has the same energy in every harmonic, and cannot
/// hide in weights computed from noisy triangles.
/// @param F  each of the n vertices is in some triangle.
SparseMatrix uniformStiffness(Index n, const Faces& F);

/// D_ii is a third of the area of the triangles at vertex i.
Eigen::VectorXd lumpedMass(const Vertices& V, const Faces& F);

/// Whether all entries are finite and all masses positive; false when triangles have collapsed.
bool isUsable(const Laplacian& laplacian);

/// @throws SolverFailure  with code DegenerateTriangles, unless isUsable.
void requireUsable(const Laplacian& laplacian);

}  // namespace spectral
