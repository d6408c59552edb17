#pragma once

#include <optional>

#include "core/harmonics/harmonic_basis.h"
#include "core/laplacian/laplacian.h"
#include "core/ldlt/shifted_ldlt.h"
#include "core/support/progress.h"
#include "core/support/types.h"

namespace spectral {

/// At least the k lowest eigenpairs, certified. Computed interval by interval (spectrum_slicing.h),
/// each by Spectra (interval_pairs.h), or by the dense solver where that is faster.
///
/// The basis never ends inside a cluster of equal eigenvalues: if lambda_k and lambda_k+1 are equal
/// or nearly so, a few more than k pairs are returned. The certificate: the inertia of W - sigma D
/// counts as many eigenvalues below the cut (Sylvester's law of inertia), or an error is thrown;
/// residuals are reported (typically 1e-9, more with collapsed triangles; above 1e-2 an error).
///
/// @param k         number of constant modes < k < n.
/// @param ldlt      provides the symbolic analysis and counts the work; its factor is kept.
/// @throws InvalidOption  when k is out of range; SolverFailure when the basis fails its count;
///                        Cancelled.
HarmonicBasis truncatedBasis(const Laplacian& laplacian, Index k, ShiftedLdlt& ldlt,
                             const Progress& progress = {});

/// All harmonics below an edge of a gain, omega^2 = lambda, and at least one besides the constants;
/// on small meshes, all n.
/// @param edge  a frequency > 0.
/// @throws InvalidOption  when there are more than 1,000.
/// @throws SolverFailure, Cancelled
HarmonicBasis harmonicsUpTo(double edge, const Laplacian& laplacian, ShiftedLdlt& ldlt,
                            const Progress& progress = {});

/// |D^-1/2 (W phi - lambda D phi)| / |lambda| of every harmonic but the constants; 0 there.
Eigen::VectorXd relativeResiduals(const Laplacian& laplacian, const HarmonicBasis& basis,
                                  const Progress& progress);

/// The smallest number of pairs >= `asked` at which the spectrum can be cut: the next eigenvalue
/// must differ from the last one by more than the width of a cluster. Empty if there is none.
///
/// @param lambda  the lowest eigenvalues, ascending, including the one after `asked`.
std::optional<Index> cutOutsideClusters(const Eigen::VectorXd& lambda, Index asked);

}  // namespace spectral
