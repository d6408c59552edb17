#pragma once

#include <vector>

#include "components.h"
#include "harmonic_basis.h"
#include "laplacian.h"
#include "progress.h"
#include "shifted_ldlt.h"

namespace spectral {

/// What an update has to hold, else the basis is computed anew.
struct UpdateGate {
    /// Mean residual of previous harmonics under the new Laplacian, defined as below: of some, and
    /// of all next to the cut. Beyond it nothing is tried: half of the updates would be in vain.
    double largestChange = 0.13;

    /// Largest bound on the part of a harmonic that lies beyond the basis: its residual
    /// |D^-1/2 (W phi - lambda D phi)| divided by its distance in the spectrum from there. Filters
    /// correct for it (leak_correction.h), up to its square.
    double largestLeak = 1e-2;

    /// Largest bound on the relative error of an eigenvalue: that part times the residual.
    double largestError = 5e-5;
};

/// What an update did.
struct BasisUpdateResult {
    bool accepted = false;
    int factorizations = 0, solves = 0;
};

/// The k lowest harmonics of a Laplacian from those of one nearby: the update of the basis as a
/// perturbation (Kovnatsky et al. 2012, end of section 3, which names no algorithm).
///
/// The previous harmonics are taken in slices, by their Rayleigh quotients under the new Laplacian.
/// Block inverse iterations with a Chebyshev filter turn each slice towards the eigenspaces round
/// its own shift (slice_iteration.h), and one Rayleigh-Ritz procedure on all slices together sorts
/// out what has moved from one to another.
///
/// At the cut that would not do: there is no gap between the last harmonic and the first that is
/// not in the basis, and where the gain jumps there, what leaks from one into the other is seen. So
/// the harmonics next to the cut, on both sides, are found by a Lanczos run, nearly as exactly as
/// those of a basis from nothing; the others are iterated towards on their complement, and the
/// nearest eigenvalue beyond is then some eigenvalues away. What they still leak into it, a little
/// (HarmonicBasis::leak), filters correct for: that is cheaper than more iterations.
///
/// Conditions checked: leaks and errors are within the gate; the inertia of W - sigma D counts at
/// the cut as many eigenvalues as the basis has, at every slice's shift as many as lie below it,
/// and at the end of the run's part of the spectrum no more than have been found up to there.
///
/// @param k      harmonics wanted. With less than some tens, or where truncatedBasis uses the dense
///               solver, nothing is accepted: a basis from nothing is as quick.
/// @param basis  of the previous Laplacian, at least k; on return of the new one, cut as by
///               truncatedBasis. Without meaning when not accepted.
/// @param factors  as of truncatedBasis; on return the first is the one that applyInLeakingBasis
///                 wants.
/// @throws Cancelled
BasisUpdateResult updateBasis(const Laplacian& laplacian, const ConstantModes& constants, Index k,
                              const UpdateGate& gate, HarmonicBasis& basis,
                              std::vector<ShiftedLdlt>& factors, const Progress& progress = {});

}  // namespace spectral
