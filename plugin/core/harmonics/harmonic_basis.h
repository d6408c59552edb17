#pragma once

#include <Eigen/Core>

#include "core/laplacian/laplacian.h"
#include "core/support/types.h"

namespace spectral {

/// Manifold harmonics: the k lowest eigenpairs of W phi = lambda D phi, or k others in succession.
struct HarmonicBasis {
    Eigen::MatrixXd Phi;     ///< n x k, D-orthonormal: Phi^T D Phi = I.
    Eigen::VectorXd lambda;  ///< k eigenvalues, ascending; exactly 0 for the constant modes.
    Index first = 0;         ///< Number of eigenvalues below them.

    // The certificate of a truncated basis; without meaning for a dense one.
    Eigen::VectorXd residuals;  ///< k, |D^-1/2 (W phi - lambda D phi)| / lambda; 0 for constants.
    Index inertiaCount = 0;     ///< Eigenvalues below the first that is not in the basis, by the
                                ///< inertia of W - sigma D: equal to size(), none is missing.

    Index size() const { return lambda.size(); }

    /// The manifold harmonic transform c = Phi^T D X, k x c.
    Eigen::MatrixXd transform(const Eigen::VectorXd& D, const Eigen::MatrixXd& X) const;

    /// Its inverse, Phi c.
    Eigen::MatrixXd inverseTransform(const Eigen::MatrixXd& c) const;
};

/// All n eigenpairs by a dense solver: O(n^3) time, 3 n^2 numbers of memory. The yardstick of the
/// tests, and what is quickest for a few hundred vertices. Eigenvalues have an error relative to
/// their own size, and with a fixed boundary one of about 1e-15 times the largest, whatever that
/// size.
/// @throws SolverFailure  when the solver does not converge.
HarmonicBasis denseBasis(const Laplacian& laplacian);

/// Whether the dense solver is the quickest way to harmonics of n vertices.
bool isDenseQuicker(Index n);

/// Largest eigenvalue of W phi = lambda D phi, to about 1e-8 relative.
/// @throws SolverFailure  when it does not converge.
double largestEigenvalue(const Laplacian& laplacian);

/// Y = Phi F(Lambda^1/2) Phi^T D X + residualGain (X - Phi Phi^T D X)
/// (Vallet and Levy 2008; Kovnatsky et al. 2012, Eqs. 6 to 8).
///
/// @param residualGain  gain of all that is beyond the basis (Eq. 9); 0 drops it (Eq. 6).
/// The constant modes keep gain 1.
Eigen::MatrixXd applyInBasis(const HarmonicBasis& basis, const Laplacian& laplacian,
                             const Gain& gain, double residualGain, const Eigen::MatrixXd& X);

}  // namespace spectral
