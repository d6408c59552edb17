#pragma once

#include <optional>

#include "core/laplacian/frequency.h"
#include "core/laplacian/laplacian.h"

namespace spectral {

/// An interval of eigenvalues.
struct SpectrumRange {
    double lowest;   ///< About the first eigenvalue that is not zero, units of lambda, > 0.
    double highest;  ///< Upper end of the bulk, > lowest.
};

struct Pole {
    double shift = 0.0;  ///< lambda_p > 0, in units of lambda.

    /// Dimension from which on a space can tell the gain from a smoother one: below it, changes
    /// from one dimension to the next say nothing of the error.
    int resolution = 1;
};

/// The pole for which a rational Krylov space resolves a gain with the fewest dimensions.
///
/// In the variable theta = lambda_p / (lambda + lambda_p) the Krylov method with the repeated pole
/// -lambda_p approximates F by polynomials on (0, 1]. For each of a range of poles the degree that
/// F needs there is read off its Chebyshev coefficients, and the pole with the lowest degree is
/// taken. A steep cutoff wants the pole at the cutoff; a Gaussian, which is smooth there and falls
/// off exponentially, one far above it (half the solves); a weak fractional power of a slowly
/// falling gain one in between.
///
/// A gain that no such polynomial resolves (with a cusp where it vanishes, say) gets the pole that
/// comes nearest.
///
/// @param gain      continuous on the range.
/// @param cutoff    omega_c > 0, around which poles are tried.
/// @param range     the part of the spectrum that matters; see `bulkSpectrum`.
/// @param accuracy  absolute error of the gain, > 0.
Pole selectPole(const Gain& gain, double cutoff, const SpectrumRange& range, double accuracy);

/// Dimension of a Krylov space that is enough for the accuracy whatever the signal is, relative to
/// its D-norm, on all of the spectrum. Empty where more than 32 would be needed: few signals need
/// as many, and their spaces tell.
std::optional<int> sufficientDimension(const Gain& gain, double pole, double accuracy);

/// The range of the bulk of the eigenvalues of W phi = lambda D phi.
///
/// Below: a tenth of the scale 4 pi / area of the first ones (Weyl's law). Above: the largest
/// eigenvalue belongs to the worst sliver of the mesh and to nothing else; the 99th percentile of
/// 2 W_ii / D_ii (Gershgorin's bound, vertex by vertex) bounds what the rest holds.
SpectrumRange bulkSpectrum(const Laplacian& laplacian);

}  // namespace spectral
