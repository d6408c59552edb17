#pragma once

#include <Eigen/Core>
#include <optional>

#include "harmonic_basis.h"
#include "laplacian.h"
#include "progress.h"
#include "shifted_ldlt.h"

namespace spectral {

/// The number of pairs, from `asked` on, at which a spectrum may be cut: where the next eigenvalue
/// is not equal to the last one or nearly so. Empty when every candidate lies inside a cluster.
///
/// @param lambda  ascending, more than `asked` entries.
std::optional<Index> cutOutsideClusters(const Eigen::VectorXd& lambda, Index asked);

/// Fills in the certificate of a basis: residuals, largestOverlap and inertiaCount.
///
/// @param constants  number of constant modes, whose residual is 0.
/// @param cut        a shift between the last eigenvalue of the basis and the next one, where the
///                   eigenvalues below it are counted. None where the basis holds all that there
///                   are: inertiaCount is its size.
/// @param factor     of any shift; for its storage.
/// @throws SolverFailure  when they are not finite; Cancelled.
void certifyBasis(const Laplacian& laplacian, Index constants, std::optional<double> cut,
                  ShiftedLdlt& factor, HarmonicBasis& basis, const Progress& progress);

}  // namespace spectral
