#pragma once

#include <Eigen/Core>

#include "core/laplacian/laplacian.h"
#include "core/support/types.h"

namespace spectral {

/// Manifold harmonics: the k lowest eigenpairs of W phi = lambda D phi.
struct HarmonicBasis {
    Eigen::MatrixXd Phi;     ///< n x k, D-orthonormal: Phi^T D Phi = I.
    Eigen::VectorXd lambda;  ///< k eigenvalues, ascending; exactly 0 for the constant modes.

    // The certificate of a truncated basis; meaningless for a dense one.
    Eigen::VectorXd residuals;  ///< k, |D^-1/2 (W phi - lambda D phi)| / lambda; 0 for constants.
    Index inertiaCount = 0;  ///< Eigenvalues below the first one beyond the basis, by the inertia
                             ///< of W - sigma D: none is missing if it equals size().

    Index size() const { return lambda.size(); }

    /// The manifold harmonic transform c = Phi^T D X, k x c.
    Eigen::MatrixXd transform(const Eigen::VectorXd& D, const Eigen::MatrixXd& X) const;

    /// The inverse transform Phi c.
    Eigen::MatrixXd inverseTransform(const Eigen::MatrixXd& c) const;
};

/// All n eigenpairs by a dense solver: O(n^3) time, memory for 3 n^2 numbers. The reference in
/// tests, and the fastest solver for a few hundred vertices. The error of an eigenvalue is relative
/// to its own size; with a fixed boundary, about 1e-15 times the largest one is added.
/// @throws SolverFailure  when the solver does not converge.
HarmonicBasis denseBasis(const Laplacian& laplacian);

/// Whether the dense solver is the fastest for n vertices.
bool isDenseQuicker(Index n);

/// Largest eigenvalue of W phi = lambda D phi, relative error about 1e-8.
/// @throws SolverFailure  when it does not converge.
double largestEigenvalue(const Laplacian& laplacian);

/// Y = Phi F(Lambda^1/2) Phi^T D X + residualGain (X - Phi Phi^T D X)
/// (Vallet and Levy 2008; Kovnatsky et al. 2012, Eqs. 6 to 8).
///
/// @param residualGain  gain of everything beyond the basis (Eq. 9); 0 drops it (Eq. 6).
/// The constant modes keep gain 1.
Eigen::MatrixXd applyInBasis(const HarmonicBasis& basis, const Laplacian& laplacian,
                             const Gain& gain, double residualGain, const Eigen::MatrixXd& X);

}  // namespace spectral
