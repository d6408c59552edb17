#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/laplacian/laplacian.h"
#include "core/ldlt/shifted_ldlt.h"
#include "core/support/progress.h"
#include "core/support/types.h"

namespace spectral {

/// An interval of the spectrum of W phi = lambda D phi.
struct SpectralInterval {
    double from = 0.0, to = 0.0;  ///< from <= lambda < to.
    Index first = 0;              ///< Number of eigenvalues below `from`, exact.
    Index count = 0;              ///< Number of eigenvalues in the interval, exact.

    double middle() const { return 0.5 * (from + to); }
};

/// Divides the lower end of the spectrum, at least its k lowest eigenvalues, into intervals of
/// about `width` eigenvalues (spectrum slicing; the bands of Vallet and Levy 2008, section 3.3).
///
/// The inertia of W - sigma D counts the eigenvalues below each cut (Sylvester's law of inertia),
/// so the number of harmonics in each interval is known. The constant modes are in no interval.
///
/// @param k        number of constant modes < k < n.
/// @param factors  one for each thread of the team.
/// @return ascending intervals that miss no eigenvalue; they start after the constant modes.
/// @throws SolverFailure  when there is no such division; Cancelled.
std::vector<SpectralInterval> sliceSpectrum(const Laplacian& laplacian, Index k, Index width,
                                            std::vector<ShiftedLdlt>& factors,
                                            const Progress& progress);

}  // namespace spectral
