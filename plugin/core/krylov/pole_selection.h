#pragma once

#include "core/laplacian/laplacian.h"
#include "core/support/types.h"

namespace spectral {

/// An interval of eigenvalues.
struct SpectrumRange {
    double lowest;   ///< About the first nonzero eigenvalue, units of lambda, > 0.
    double highest;  ///< Upper end of the bulk, > lowest.
};

/// The pole with which a rational Krylov space resolves a gain in the fewest dimensions.
///
/// In the variable theta = lambda_p / (lambda + lambda_p) the Krylov method with the repeated pole
/// -lambda_p approximates F by polynomials on (0, 1]. For a range of poles, the required degree is
/// read off the Chebyshev coefficients of F; the pole of lowest degree is chosen. A steep cutoff
/// needs the pole at the cutoff; a Gaussian, smooth there and decaying exponentially, one far above
/// it (half the solves); a small fractional power of a slowly decaying gain one in between.
///
/// A gain that no such polynomial resolves (because of a cusp where it vanishes, say) gets the pole
/// that comes closest. Poles whose nodes miss a peak or a notch anywhere are rejected; if all are,
/// the pole at the cutoff is returned. No pole is far beyond the range, where (W + lambda_p D)^-1 D
/// would be constant to within round-off.
///
/// @param gain      continuous on the range.
/// @param cutoff    omega_c > 0; candidate poles are powers of two times its square.
/// @param range     the part of the spectrum that matters; see `bulkSpectrum`.
/// @param accuracy  absolute error of the gain, > 0.
/// @return  lambda_p > 0, in units of lambda.
double selectPole(const Gain& gain, double cutoff, const SpectrumRange& range, double accuracy);

/// The range of the bulk of the eigenvalues of W phi = lambda D phi.
///
/// Lower end: a tenth of the scale 4 pi / area of the first eigenvalues (Weyl's law). Upper end:
/// the 99th percentile of 2 W_ii / D_ii (Gershgorin's bound at each vertex), because the largest
/// eigenvalue depends on the worst sliver alone.
SpectrumRange bulkSpectrum(const Laplacian& laplacian);

}  // namespace spectral
