#pragma once

#include <vector>

#include "core/laplacian/constant_modes.h"
#include "core/laplacian/frequency.h"
#include "core/ldlt/cholesky.h"
#include "core/support/progress.h"

namespace spectral {

struct FullSpectrumOptions {
    double accuracy = 1e-6;  ///< Requested error of Y, relative as in FullSpectrumResult.
    int maxDimension = 200;  ///< Krylov dimension of a column at which to stop short of it.

    int resolution = 1;  ///< Dimension below which there is no telling; see Pole.

    /// Whether the accuracy is for every vertex. Else for the surface: for |dY|_D / |X|_D alone.
    bool atEveryVertex = true;
};

struct FullSpectrumResult {
    Eigen::MatrixXd Y;  ///< n x c, the filtered signals.

    /// Estimated error of Y, relative to the part of X that is not constant: the larger of
    /// |dY|_D / |X|_D and max|dY| / max|X| over all columns together.
    double errorEstimate = 0.0;
    int dimension = 0;  ///< Krylov dimension reached: solves per column.

    /// Whether the requested accuracy was reached. It is not when F is too steep for maxDimension,
    /// or has a cusp, as the fractional powers of a band-stop with stop gain 0 have at its centre.
    bool converged = false;
};

/// Y = F(sqrt(A)) X over the whole spectrum, without computing an eigenvector.
///
/// The same as with all n harmonics, Y = Phi F(Lambda^1/2) Phi^T D X (Kovnatsky et al. 2012, Eq.
/// 6), as the action of a function of a matrix: a shift-invert Lanczos method with one repeated
/// real pole (krylov_spaces.h). In the Krylov space of S = (W + lambda_p D)^-1 D and x, with
/// D-orthonormal basis U and T = U^T D S U,
///     F(sqrt(A)) x ~ |x|_D U F(sqrt(T^-1 - lambda_p)) e_1.
/// The columns of X run in step, so that one pass over the Cholesky factor serves all of them.
///
/// The stopping rule is a posteriori: from the differences of approximations a few dimensions
/// apart, over the surface and at every vertex, and the rate at which they shrink. Over the surface
/// the dimension that is enough for every signal ends it, too.
///
/// @param D         lumped masses of the Laplacian.
/// @param cholesky  factorization of W + lambda_p D; see selectPole for lambda_p.
/// @param gain      continuous, finite and >= 0 on [0, infinity]; constant modes keep gain 1.
/// @param X         n x c signals, e.g. the three coordinates.
/// @throws SolverFailure  when a small eigenproblem of the method fails.
FullSpectrumResult applyFullSpectrum(const Eigen::VectorXd& D, const ConstantModes& constants,
                                     const ShiftedCholesky& cholesky, const Gain& gain,
                                     const Eigen::MatrixXd& X, const FullSpectrumOptions& options,
                                     const Progress& progress = {});

/// The same for several gains, from the same Krylov spaces.
std::vector<FullSpectrumResult> applyFullSpectrum(
    const Eigen::VectorXd& D, const ConstantModes& constants, const ShiftedCholesky& cholesky,
    const std::vector<Gain>& gains, const Eigen::MatrixXd& X, const FullSpectrumOptions& options,
    const Progress& progress = {});

}  // namespace spectral
