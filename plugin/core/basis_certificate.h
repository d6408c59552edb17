#pragma once

#include <Eigen/Core>
#include <optional>

#include "harmonic_basis.h"
#include "laplacian.h"
#include "progress.h"

namespace spectral {

/// The number of pairs, from `asked` on, at which a spectrum may be cut: where the next eigenvalue
/// is not equal to the last one or nearly so. Empty when every candidate lies inside a cluster.
///
/// @param lambda  ascending, more than `asked` entries.
std::optional<Index> cutOutsideClusters(const Eigen::VectorXd& lambda, Index asked);

/// Fills in residuals and largestOverlap of a basis.
///
/// @param constants  number of constant modes, whose residual is 0.
/// @throws SolverFailure  when they are not finite; Cancelled.
void measureBasis(const Laplacian& laplacian, Index constants, HarmonicBasis& basis,
                  const Progress& progress);

}  // namespace spectral
