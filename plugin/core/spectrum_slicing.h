#pragma once

#include <vector>

#include "components.h"
#include "laplacian.h"
#include "progress.h"
#include "shifted_ldlt.h"
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
/// Shifts are laid through the spectrum, some tens of eigenvalues apart (the bands of Vallet and
/// Levy 2008, section 3.3). A short Lanczos run with (W - sigma D)^-1 D finds the pairs on both
/// sides of each, and the inertia of the same factorization counts the eigenvalues below it. So the
/// number of pairs between two shifts is known, and how many of them are missing: those that the
/// runs have not reached, and copies of multiple eigenvalues. A second wave of runs finds them, on
/// the complement of the pairs that are known on both sides; where that is not enough, further
/// waves do, until no count misses a pair. The runs of a wave are independent of each other and
/// share the machine's cores; the result does not depend on their number. The cost is linear in k,
/// but for a small part.
///
/// @param k  constants.count() < k < n.
/// @param factors  as of truncatedBasis.
/// @throws SolverFailure  when pairs stay missing; Cancelled.
LowestPairs lowestPairs(const Laplacian& laplacian, const ConstantModes& constants, Index k,
                        std::vector<ShiftedLdlt>& factors, const Progress& progress = {});

}  // namespace spectral
