#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "cholesky.h"
#include "components.h"
#include "laplacian.h"
#include "progress.h"
#include "shifted_ldlt.h"
#include "transfer_function.h"

namespace spectral {

/// Manifold harmonics: the k lowest eigenpairs of W phi = lambda D phi.
struct HarmonicBasis {
    Eigen::MatrixXd Phi;     ///< n x k, D-orthonormal: Phi^T D Phi = I.
    Eigen::VectorXd lambda;  ///< k eigenvalues, ascending; exactly 0 for the constant modes.

    // The certificate of a truncated basis; without meaning for a dense one.
    Eigen::VectorXd residuals;    ///< k, |D^-1/2 (W phi - lambda D phi)| / lambda; 0 for constants.
    double largestOverlap = 0.0;  ///< Of Phi^T D Phi - I, for neighbours in the spectrum.
    Index inertiaCount = 0;       ///< Eigenvalues below the first that is not in the basis, by the
                                  ///< inertia of W - sigma D: equal to size(), none is missing.

    /// Where harmonics are not those of the Laplacian alone, but leak into others beyond the basis:
    /// in one that an update has made.
    struct Leak {
        double from = 0.0;  ///< The largest eigenvalue of a harmonic that leaks.
        double into = 0.0;  ///< The least eigenvalue that one leaks into, > from.
    };
    std::optional<Leak> leak;

    Index size() const { return lambda.size(); }
};

/// All n eigenpairs by a dense solver: O(n^3) time, 3 n^2 numbers of memory. The yardstick of the
/// tests, and what is quickest for a few hundred vertices.
/// @throws SolverFailure  when the solver does not converge.
HarmonicBasis denseBasis(const Laplacian& laplacian, const ConstantModes& constants);

/// Whether the dense solver is the quickest way to harmonics of n vertices.
bool isDenseQuicker(Index n);

/// At least the k lowest eigenpairs, certified: slice by slice (spectrum_slicing.h), or by the
/// dense solver where that is quicker.
///
/// The cut is never inside a cluster of equal eigenvalues: a few pairs more than k are taken where
/// lambda_k and lambda_k+1 are equal or nearly so. The certificate: as many pairs as the inertia of
/// W - sigma D counts below the cut (Sylvester's law of inertia), or an error; residuals and
/// overlaps as reported (1e-9 is usual, more where triangles have collapsed).
///
/// @param k  constants.count() < k < n.
/// @param cholesky  counts the work; its factor is left as it is.
/// @param factors  one for each core, those that made an earlier basis, or none: while W keeps its
///                 pattern they need no symbolic analysis.
/// @throws InvalidOption  when k is out of range; SolverFailure when the basis fails its
///                        count.
HarmonicBasis truncatedBasis(const Laplacian& laplacian, const ConstantModes& constants, Index k,
                             ShiftedCholesky& cholesky, std::vector<ShiftedLdlt>& factors,
                             const Progress& progress = {});

/// The same, with factors of its own.
HarmonicBasis truncatedBasis(const Laplacian& laplacian, const ConstantModes& constants, Index k,
                             ShiftedCholesky& cholesky, const Progress& progress = {});

/// Largest eigenvalue of W phi = lambda D phi, to about 1e-8 relative.
double largestEigenvalue(const Laplacian& laplacian);

/// F(Lambda^1/2): the gains of the harmonics, k.
Eigen::ArrayXd gainsOf(const HarmonicBasis& basis, const Gain& gain);

/// Y = Phi F(Lambda^1/2) Phi^T D X + residualGain (X - Phi Phi^T D X)
/// (Vallet and Levy 2008; Kovnatsky et al. 2012, Eqs. 6 to 8).
///
/// @param residualGain  gain of all that is beyond the basis (Eq. 9); 0 drops it (Eq. 6).
/// The constant modes keep gain 1. What harmonics leak is left as it is (see leak_correction.h).
Eigen::MatrixXd applyInBasis(const HarmonicBasis& basis, const Eigen::VectorXd& D,
                             const ConstantModes& constants, const Gain& gain, double residualGain,
                             const Eigen::MatrixXd& X);

}  // namespace spectral
