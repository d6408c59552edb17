#pragma once

#include "components.h"
#include "harmonic_basis.h"
#include "laplacian.h"
#include "progress.h"

namespace spectral {

/// What an update has to hold, else the basis is computed anew. The error of an eigenvalue goes
/// with the square of its residual r: some 10 r^2 were seen, relative.
struct UpdateGate {
    /// Largest |D^-1/2 (W phi - lambda D phi)| / lambda of any harmonic, and their mean.
    double largestResidual = 3e-3, meanResidual = 3e-4;
};

/// What an update did.
struct BasisUpdateResult {
    bool accepted = false;
    int factorizations = 0, solves = 0;
};

/// The k lowest harmonics of a Laplacian from those of one nearby: the update of the basis as a
/// perturbation (Kovnatsky et al. 2012, end of section 3, which names no algorithm).
///
/// The previous harmonics and guards are sorted by their Rayleigh quotients under the new Laplacian
/// and taken in slices. Two block inverse iterations turn each slice towards the eigenspaces round
/// its own shift sigma, S <- (W - sigma D)^-1 D S; then one Rayleigh-Ritz procedure on all slices
/// together sorts out what has moved from one slice to another. The accuracy is that of a
/// perturbation: eigenvalues to about 1e-5, where a basis from nothing has 1e-10.
///
/// The filter does not use it yet. Vectors next to the cut are mixed with those beyond it by the
/// residual divided by the distance of eigenvalues. Where the gain jumps at the cut that moves
/// vertices by 1e-5 to 1e-4 of the diagonal in ten steps: more than what is allowed for.
///
/// Two conditions are checked: the residuals are within the gate, and the inertia of every slice's
/// W - sigma D counts as many eigenvalues below sigma as the basis has.
///
/// @param k      harmonics wanted.
/// @param basis  of the previous Laplacian, with guards; on return of the new one, certified as by
///               truncatedBasis, and as many columns. Without meaning when not accepted.
/// @throws Cancelled
BasisUpdateResult updateBasis(const Laplacian& laplacian, const ConstantModes& constants, Index k,
                              const UpdateGate& gate, HarmonicBasis& basis,
                              const Progress& progress = {});

}  // namespace spectral
