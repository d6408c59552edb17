#pragma once

#include "core/laplacian/interior.h"
#include "core/laplacian/laplacian_builder.h"
#include "core/mesh/mesh.h"
#include "core/support/progress.h"
#include "core/support/types.h"

namespace spectral {

struct HarmonicsOptions {
    int basisSize = 100;  ///< k, the constant modes included and above their number; below the
                          ///< number of vertices of triangles, without those of a fixed boundary.
    LaplacianKind laplacian = LaplacianKind::IntrinsicDelaunay;
    Boundary boundary = Boundary::Free;
};

struct ManifoldHarmonics {
    Eigen::VectorXd lambda;  ///< k eigenvalues, ascending, 1 / length^2; exactly 0 for the constant
                             ///< mode of every component, unless its boundary is fixed.
    Eigen::MatrixXd Phi;     ///< n x k, D-orthonormal, 1 / length; 0 at unreferenced vertices and
                             ///< on a fixed boundary.
    int wholeSize = 0;       ///< >= k: the size at which no group of equal eigenvalues is cut.

    // The certificate; see HarmonicBasis.
    Eigen::VectorXd residuals;  ///< k, relative, 0 for the constant modes.
    int inertiaCount = 0;       ///< Eigenvalues below the first beyond wholeSize, counted by the
                                ///< inertia of W - sigma D: equal to wholeSize, none is missing.
};

/// The k lowest manifold harmonics of a mesh, W phi = lambda D phi (Vallet and Levy 2008; Kovnatsky
/// et al. 2012, Eq. 4), each with a definite sign; see `fixSigns`.
///
/// Harmonics of equal eigenvalues are any D-orthonormal basis of their space.
///
/// @param V  n x 3 positions, finite.
/// @param F  m x 3 vertex indices, m >= 1; any topology, unreferenced vertices allowed.
/// @throws InvalidMesh, InvalidOption, SolverFailure, Cancelled
ManifoldHarmonics manifoldHarmonics(const Vertices& V, const Faces& F,
                                    const HarmonicsOptions& options, const Progress& progress = {});

/// Gives every column of Phi the sign that makes its extreme entry positive.
///
/// The extreme entry is the one of largest absolute value. Entries within one millionth of it are
/// taken for equal to it, as those of a symmetric mesh are but for round-off; of these the first
/// one counts.
void fixSigns(Eigen::MatrixXd& Phi);

}  // namespace spectral
