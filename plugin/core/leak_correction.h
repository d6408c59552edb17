#pragma once

#include <Eigen/Core>

#include "components.h"
#include "harmonic_basis.h"
#include "progress.h"
#include "shifted_ldlt.h"
#include "transfer_function.h"

namespace spectral {

/// The shift from which the leaks of a basis are best computed: the polynomial below is then of the
/// lowest degree for its accuracy. In the middle of a gap between two harmonics, where solves lose
/// nothing.
double correctionShift(const HarmonicBasis& basis);

/// applyInBasis for a basis whose harmonics leak, corrected to first order.
///
/// The harmonics are Ritz vectors: W phi_i = lambda_i D phi_i + r_i, where no r_i has anything in
/// common with the basis. In it and in the rest of space F(sqrt(A)) has the gains F(Lambda^1/2) and
/// F_h; what the r_i mix of the two is, to first order in them, a matter of divided differences of
/// F (Daleckii and Krein 1965; Higham, Functions of Matrices, 2008, section 3.2). With
/// e_i = (A - lambda_i)^-1 D^-1 r_i on the rest, which is what phi_i leaks, applyInBasis has too
/// much of
///
///     sum_i g_i (e_i phi_i^T D X + phi_i e_i^T D X),  g_i = F(lambda_i^1/2) - F_h.
///
/// No e_i is computed. Let t(mu) = 1 / (mu - sigma) with one shift for all, and N a polynomial that
/// is small at all t(mu) of the rest beside its values at the t(lambda_i), which are on either side
/// of them. N(t(A)) phi_i is N(t(lambda_i)) times phi_i - e_i, but for so little in the rest. With
/// Q = I - Phi Phi^T D, the projection onto the rest, the sum is therefore
///
///     - Q N(t(A)) Phi G Phi^T D X - Phi G Phi^T D N(t(A)) Q X,  G = diag(g_i / N(t(lambda_i))):
///
/// a few solves for the columns of X.
///
/// What remains wrong is some hundredths of the correction, and the square of what leaks.
///
/// @param D, gain, residualGain, X  as those of applyInBasis.
/// @param basis   with a leak.
/// @param factor  of W - sigma D, sigma the correctionShift of the basis.
/// @throws Cancelled
Eigen::MatrixXd applyInLeakingBasis(const HarmonicBasis& basis, const Eigen::VectorXd& D,
                                    const ConstantModes& constants, const Gain& gain,
                                    double residualGain, const Eigen::MatrixXd& X,
                                    const ShiftedLdlt& factor, const Progress& progress = {});

}  // namespace spectral
