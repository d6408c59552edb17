#pragma once

#include "laplacian.h"
#include "transfer_function.h"

namespace spectral {

/// The pole lambda_p for which a rational Krylov space resolves a gain with the fewest dimensions.
///
/// In the variable theta = lambda_p / (lambda + lambda_p) the Krylov method with the repeated pole
/// -lambda_p approximates F by polynomials on (0, 1]. For each of a range of poles the degree that F
/// needs there is read off its Chebyshev coefficients, and the pole with the lowest degree is taken.
/// A steep cutoff wants the pole at the cutoff; a Gaussian, which is smooth there and falls off
/// exponentially, one far above it (half the solves); a weak fractional power of a slowly falling
/// gain one in between.
///
/// @param gain      continuous on [0, lambdaMax].
/// @param cutoff    omega_c > 0, around which poles are tried.
/// @param lambdaMax end of the part of the spectrum that matters; see `bulkSpectrumEnd`.
/// @param accuracy  absolute error of the gain, > 0.
/// @return          lambda_p > 0, in units of lambda.
double selectPole(const Gain& gain, double cutoff, double lambdaMax, double accuracy);

/// Upper end of the bulk of the spectrum of W phi = lambda D phi.
///
/// The largest eigenvalue belongs to the worst sliver of the mesh and to nothing else; the 99th
/// percentile of 2 W_ii / D_ii (Gershgorin's bound, vertex by vertex) bounds what the rest holds.
double bulkSpectrumEnd(const Laplacian& laplacian);

}  // namespace spectral
