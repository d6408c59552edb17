#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

#include "harmonic_basis.h"
#include "laplacian.h"
#include "progress.h"
#include "types.h"

namespace spectral {

/// The number of pairs, from `asked` on, at which a spectrum may be cut: where the next eigenvalue
/// is not equal to the last one or nearly so. Empty when every candidate lies inside a cluster.
///
/// @param lambda  ascending, more than `asked` entries.
std::optional<Index> cutOutsideClusters(const Eigen::VectorXd& lambda, Index asked);

/// Fills in what the certificate of a basis has to say of its pairs: residuals and largestOverlap.
///
/// @param constants  number of constant modes, whose residual is 0.
/// @param beside     done meanwhile by one core: the count by inertia, for example.
/// @throws SolverFailure  when they are not finite; Cancelled, and whatever `beside` throws.
void measureBasis(const Laplacian& laplacian, Index constants, HarmonicBasis& basis,
                  const std::function<void()>& beside, const Progress& progress);

}  // namespace spectral
