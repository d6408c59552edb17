#pragma once

#include <optional>

#include "core/laplacian/frequency.h"
#include "core/laplacian/laplacian.h"

namespace spectral {

/// An interval of eigenvalues.
struct SpectrumRange {
    double lowest;   ///< About the first nonzero eigenvalue, units of lambda, > 0.
    double highest;  ///< Upper end of the bulk, > lowest.
};

struct Pole {
    double shift = 0.0;  ///< lambda_p > 0, in units of lambda.

    /// Smallest dimension at which a space distinguishes the gain from a smoother one: below it,
    /// changes between dimensions say nothing about the error.
    int resolution = 1;
};

/// The pole with which a rational Krylov space resolves a gain with the fewest dimensions.
///
/// In the variable theta = lambda_p / (lambda + lambda_p) the Krylov method with the repeated pole
/// -lambda_p approximates F by polynomials on (0, 1]. For a range of poles, the degree that F needs
/// is read off its Chebyshev coefficients; the pole of lowest degree is taken. A steep cutoff needs
/// the pole at the cutoff; a Gaussian, smooth there and of exponential decay, one far above it
/// (half the solves); a small fractional power of a slowly decaying gain one in between.
///
/// A gain that no such polynomial resolves (with a cusp where it vanishes, say) gets the pole that
/// comes closest.
///
/// @param gain      continuous on the range.
/// @param cutoff    omega_c > 0, around which poles are tried.
/// @param range     the part of the spectrum that matters; see `bulkSpectrum`.
/// @param accuracy  absolute error of the gain, > 0.
Pole selectPole(const Gain& gain, double cutoff, const SpectrumRange& range, double accuracy);

/// Dimension of a Krylov space that suffices for any signal, over the whole spectrum.
///
/// @param accuracy  error relative to the D-norm of the signal, > 0.
/// @return  empty above 32: few signals need as many, so that stopping a posteriori is faster.
std::optional<int> sufficientDimension(const Gain& gain, double pole, double accuracy);

/// The range of the bulk of the eigenvalues of W phi = lambda D phi.
///
/// Lower end: a tenth of the scale 4 pi / area of the first eigenvalues (Weyl's law). Upper end:
/// the 99th percentile of 2 W_ii / D_ii (Gershgorin's bound at each vertex), because the largest
/// eigenvalue is that of the worst sliver alone.
SpectrumRange bulkSpectrum(const Laplacian& laplacian);

}  // namespace spectral
