#pragma once

#include <optional>
#include <vector>

#include "core/krylov/krylov_operator.h"
#include "core/krylov/krylov_spaces.h"
#include "core/laplacian/laplacian.h"
#include "core/ldlt/shifted_ldlt.h"
#include "core/support/progress.h"
#include "core/support/types.h"

namespace spectral {

struct FullSpectrumOptions {
    double accuracy = 1e-6;  ///< Requested error of Y, relative as in FullSpectrumResult.
    /// Of several gains, that of all but the middle one, if larger.
    double accuracyOfOthers = 0.0;
    int maxDimension = 200;  ///< Krylov dimension at which to give up.
    /// Give up without a result if more than this number of products per column is needed.
    std::optional<int> affordable;
    bool atEveryVertex = true;  ///< If false, only |dY|_D / |X|_D, over the surface, is bounded.

    /// Round-off of solves, relative to the largest eigenvalue of the inverse, if known to exceed
    /// KrylovSpaces::roundOff.
    double roundOff = 0.0;

    /// Value of roundOffAtVertices(), if known, for the error at every vertex. Without it, the
    /// bound uses the smallest mass: a gross overestimate where parts have shrunk to nothing.
    std::optional<double> roundOffAtVertices;

    /// Extra frequencies at which to sample the gains, besides eighths of octaves; the gains must
    /// vary little in between.
    std::vector<double> samples;
};

/// Factor on the error estimate without convergence: at a cusp the changes decay more slowly than
/// any geometric series. Large enough for all cusps of full_spectrum_test.
inline constexpr double kNotConverged = 3.0;

struct FullSpectrumResult {
    Eigen::MatrixXd Y;  ///< n x c, the filtered signals.

    /// Estimated error of Y, relative to X without its constants: the larger of |dY|_D / |X|_D and
    /// max|dY| / max|X|, over all columns together, or over each block of those evaluated at once
    /// (rows.h) if there are more.
    double errorEstimate = 0.0;
    int dimension = 0;  ///< Krylov dimension reached: applications of S per column.

    /// Whether errorEstimate is within the accuracy. False when F is too steep or has a cusp, as
    /// fractional powers of a band-stop with stop gain 0 have at its centre.
    bool converged = false;
};

/// Y = F(sqrt(A)) X over the whole spectrum for several gains F, without computing eigenvectors.
///
/// Equals the result with all n harmonics, Y = Phi F(Lambda^1/2) Phi^T D X (Kovnatsky et al. 2012,
/// Eq. 6). Computed by a Chebyshev series in S (series_evaluation.h); by a Lanczos method
/// (krylov_spaces.h) if F is steep or has a cusp, or where there are many gains, which share one
/// space.
///
/// The stopping rule of the latter is a posteriori: over the surface by a bound from the spectral
/// measure (KrylovSpaces::squaredErrorBound), at every vertex from the differences between
/// approximations a few dimensions apart and their rate of decay.
///
/// @param gains  continuous, finite and >= 0 on [0, infinity]; constant modes keep gain 1.
/// @param X      n x c signals, e.g. the three coordinates; any number.
/// @return       one result per gain, all from the same Krylov spaces; empty if it gives up.
/// @throws SolverFailure  when the tridiagonal eigenproblem does not converge, or the solves are
///                        lost in round-off (KrylovSpaces::roundOff).
std::vector<FullSpectrumResult> applyFullSpectrum(const Laplacian& laplacian,
                                                  const KrylovOperator& S,
                                                  const std::vector<Gain>& gains, const Signals& X,
                                                  const FullSpectrumOptions& options,
                                                  const Progress& progress = {});

/// Largest round-off at any vertex in a solve whose solution is 1 everywhere: with a free boundary,
/// the eigenvector of the largest eigenvalue of the inverse.
/// @param ldlt  factorization of W + pole D.
double roundOffAtVertices(const ShiftedLdlt& ldlt, const Laplacian& laplacian);

}  // namespace spectral
