#pragma once

#include <vector>

#include "core/laplacian/constant_modes.h"
#include "core/laplacian/laplacian.h"
#include "core/ldlt/shifted_ldlt.h"
#include "core/support/progress.h"
#include "core/support/types.h"

namespace spectral {

/// A part of the spectrum of W phi = lambda D phi, and how many eigenvalues it holds.
struct SpectrumSlice {
    double from = 0.0, to = 0.0;  ///< from <= lambda < to.
    Index first = 0, count = 0;  ///< Eigenvalues below `from`, and in the slice: exact, by inertia.

    double middle() const { return 0.5 * (from + to); }
};

/// Cuts the lowest part of the spectrum, at least k eigenvalues, into slices of about `width`
/// eigenvalues: the bands of Vallet and Levy 2008, section 3.3.
///
/// The inertia of W - sigma D counts the eigenvalues below every cut (Sylvester's law), so that it
/// is known how many harmonics a slice must give. The constant modes are in none of them.
///
/// @param k        constants.count() < k < n.
/// @param factors  one for each worker; of W's pattern, or of none yet.
/// @return ascending, without gaps from the constant modes on.
/// @throws SolverFailure  when there is no such cut; Cancelled.
std::vector<SpectrumSlice> sliceSpectrum(const Laplacian& laplacian, const ConstantModes& constants,
                                         Index k, Index width, std::vector<ShiftedLdlt>& factors,
                                         const Progress& progress);

}  // namespace spectral
