#pragma once

#include "core/laplacian/interior.h"
#include "core/laplacian/laplacian_builder.h"
#include "core/support/progress.h"

namespace spectral {

struct HarmonicsOptions {
    int basisSize = 100;  ///< k, including constant modes: above their number, below the number of
                          ///< vertices that are on triangles and not fixed.
    LaplacianKind laplacian = LaplacianKind::IntrinsicDelaunay;
    Boundary boundary = Boundary::Free;
};

struct ManifoldHarmonics {
    Eigen::VectorXd lambda;  ///< k eigenvalues, ascending, 1 / length^2; exactly 0 for the constant
                             ///< mode of every component without fixed vertices.
    Eigen::MatrixXd Phi;     ///< n x k, D-orthonormal, 1 / length; 0 at unreferenced vertices and
                             ///< on a fixed boundary.
    int wholeSize = 0;       ///< Size >= k that splits no multiple eigenvalue.

    // The certificate; see HarmonicBasis.
    Eigen::VectorXd residuals;  ///< k relative residuals; 0 for the constant modes.
    int inertiaCount = 0;  ///< Eigenvalues below the first one beyond wholeSize, by the inertia
                           ///< of W - sigma D: none is missing if it equals wholeSize.
};

/// The k lowest manifold harmonics of a mesh, W phi = lambda D phi (Vallet and Levy 2008; Kovnatsky
/// et al. 2012, Eq. 4), with signs chosen by `fixSigns`.
///
/// The harmonics of a multiple eigenvalue are an arbitrary D-orthonormal basis of its eigenspace.
///
/// @param V  n x 3 positions, finite.
/// @param F  m x 3 vertex indices, m >= 1; any topology, unreferenced vertices allowed.
/// @throws InvalidMesh, InvalidOption, SolverFailure, Cancelled
ManifoldHarmonics manifoldHarmonics(const Vertices& V, const Faces& F,
                                    const HarmonicsOptions& options, const Progress& progress = {});

/// Flips columns of Phi to make the entry of largest modulus positive. Among entries equal to
/// within a relative 1e-6, as on symmetric meshes, the first one decides.
void fixSigns(Eigen::MatrixXd& Phi);

}  // namespace spectral
