#pragma once

#include <vector>

#include "core/krylov/full_spectrum.h"

namespace spectral {

/// Y = F(sqrt(A)) X for several gains, each as a Chebyshev series in S:
///     Y = F(0) X + r(S) (S - theta_0) X,  r(theta) = (F - F(0)) / (theta - theta_0),
/// with theta_0 = theta(0), the eigenvalue of the constants. The series is one of the displacement:
/// (S - theta_0) X holds the details alone, so truncation and round-off are relative to what moves.
///
/// A term takes one application of S, but no inner products, no orthogonalization and no memory
/// that grows with the degree, which is known beforehand. It is that of the whole spectrum: unlike
/// a Lanczos space, a series does not adapt to the signal. Products with A are made in single
/// precision where the accuracy allows.
///
/// Truncation is bounded by the sum of the coefficients left out, times the norm of the details;
/// at every vertex, times the largest entry of all terms.
///
/// @param omega  frequencies at which the series are compared with their gains.
/// @return       as applyFullSpectrum; empty if more than options.affordable terms are needed, or,
///               of a ShiftInvert, if the accuracy might be lost in round-off.
/// @throws Error  with code OutOfMemory, when the terms and results do not fit.
std::vector<FullSpectrumResult> applySeries(const Laplacian& laplacian, const KrylovOperator& S,
                                            const std::vector<Gain>& gains, const Signals& X,
                                            const Eigen::VectorXd& omega,
                                            const FullSpectrumOptions& options,
                                            const Progress& progress);

}  // namespace spectral
