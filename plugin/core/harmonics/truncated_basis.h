#pragma once

#include <optional>

#include "core/harmonics/harmonic_basis.h"
#include "core/laplacian/laplacian.h"
#include "core/ldlt/shifted_ldlt.h"
#include "core/support/progress.h"
#include "core/support/types.h"

namespace spectral {

/// At least the k lowest eigenpairs, certified: interval by interval (spectrum_slicing.h),
/// each by Spectra (interval_pairs.h), or by the dense solver where that is quicker.
///
/// The cut is never inside a cluster of equal eigenvalues: a few pairs more than k are taken where
/// lambda_k and lambda_k+1 are equal or nearly so. The certificate: as many pairs as the inertia of
/// W - sigma D counts below the cut (Sylvester's law of inertia), or an error; residuals as
/// reported (1e-9 is usual, more where triangles have collapsed; from 1e-2 on an error).
///
/// @param k         number of constant modes < k < n.
/// @param ldlt      shares its symbolic analysis and counts the work; its factor stays.
/// @throws InvalidOption  when k is out of range; SolverFailure when the basis fails its count;
///                        Cancelled.
HarmonicBasis truncatedBasis(const Laplacian& laplacian, Index k, ShiftedLdlt& ldlt,
                             const Progress& progress = {});

/// All harmonics below an edge of a gain, omega^2 = lambda, at least one besides the constants; all
/// that there are, where a mesh has few.
/// @param edge  a frequency > 0.
/// @throws InvalidOption  when they are more than 1,000.
/// @throws SolverFailure, Cancelled
HarmonicBasis harmonicsUpTo(double edge, const Laplacian& laplacian, ShiftedLdlt& ldlt,
                            const Progress& progress = {});

/// The eigenpairs first to last - 1, counted from 0, and some on both sides; none is missing
/// between them, by inertia. Residuals as those of truncatedBasis.
///
/// @param first, last  number of constant modes < first < last < n.
/// @throws SolverFailure, Cancelled
HarmonicBasis harmonicsBetween(const Laplacian& laplacian, Index first, Index last,
                               ShiftedLdlt& ldlt, const Progress& progress);

/// |D^-1/2 (W phi - lambda D phi)| / |lambda| of every harmonic but the constants; 0 there.
Eigen::VectorXd relativeResiduals(const Laplacian& laplacian, const HarmonicBasis& basis,
                                  const Progress& progress);

/// The number of pairs, from `asked` on, at which a spectrum may be cut: where the next eigenvalue
/// is not equal to the last one or nearly so. Empty when every candidate lies inside a cluster.
///
/// @param lambda  the eigenvalues from number `first` on, ascending, also the one after `asked`.
std::optional<Index> cutOutsideClusters(const Eigen::VectorXd& lambda, Index asked,
                                        Index first = 0);

}  // namespace spectral
