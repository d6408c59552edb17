#pragma once

#include "components.h"
#include "laplacian.h"
#include "progress.h"
#include "types.h"

namespace spectral {

/// Eigenpairs without gaps: all of those with the lowest eigenvalues.
struct LowestPairs {
    Eigen::MatrixXd Phi;     ///< n x k, D-orthonormal.
    Eigen::VectorXd lambda;  ///< k, ascending; exactly 0 for the constant modes.
    int factorizations = 0;  ///< LDL^T factorizations that it took.
    int solves = 0;          ///< Solves with one right-hand side.
};

/// At least the k lowest eigenpairs of W phi = lambda D phi, slice by slice.
///
/// Shifts sigma_1 < sigma_2 < ... are laid through the spectrum, some tens of eigenvalues apart
/// (the bands of Vallet and Levy 2008, section 3.3). A short Lanczos run with (W - sigma_i D)^-1 D
/// finds the pairs on both sides of sigma_i, and the inertia of the same factorization counts the
/// eigenvalues below it. So the number of pairs between two shifts is known: what is missing, a gap
/// or a copy of a multiple eigenvalue, is seen and sought again. The runs are independent of each
/// other and share the machine's cores; the result does not depend on their number. The cost is
/// linear in k, but for a small part.
///
/// The last pairs, above the last shift, are not yet covered by a count: see truncatedBasis.
///
/// @param k  constants.count() < k < n.
/// @throws SolverFailure  when pairs stay missing; Cancelled.
LowestPairs lowestPairs(const Laplacian& laplacian, const ConstantModes& constants, Index k,
                        const Progress& progress = {});

}  // namespace spectral
