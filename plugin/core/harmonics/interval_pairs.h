#pragma once

#include <Eigen/Core>

#include "core/harmonics/spectrum_slicing.h"
#include "core/laplacian/laplacian.h"
#include "core/ldlt/shifted_ldlt.h"
#include "core/support/threads.h"

namespace spectral {

/// The eigenpairs in an interval of the spectrum.
struct IntervalPairs {
    Eigen::MatrixXd Phi;     ///< n x count, D-orthonormal; empty if not all were found.
    Eigen::VectorXd lambda;  ///< count, ascending.

    bool isComplete() const { return Phi.cols() > 0; }
};

/// All eigenpairs in an interval, by Spectra's implicitly restarted Lanczos method for
/// (W - sigma D)^-1 D with sigma in the middle of the interval.
///
/// A single Lanczos run finds only one copy of a multiple eigenvalue, and may miss pairs at the
/// ends of the interval. As long as pairs are missing, further runs search the complement of those
/// already found.
///
/// @param factor  scratch; holds the factorization of W - sigma D on return.
/// @return incomplete if an end of the interval coincides with an eigenvalue, which then counts on
///         both sides or on neither.
/// @throws SolverFailure  when Spectra does not converge; whatever the stop point throws.
IntervalPairs computeInterval(const Laplacian& laplacian, const SpectralInterval& interval,
                              ShiftedLdlt& factor, const StopPoint& stopPoint);

/// D-orthonormalizes the columns of U, also against those of `known`, which are D-orthonormal.
///
/// @return the smallest norm of a unit column after projecting out `known` and the columns before
///         it; 0 if these are linearly dependent, and U is then meaningless. Below kOwnPart, U
///         repeats a column of `known`.
double orthonormalize(const Eigen::VectorXd& D, const Eigen::Ref<const Eigen::MatrixXd>& known,
                      Eigen::Ref<Eigen::MatrixXd> U);
inline constexpr double kOwnPart = 0.5;

}  // namespace spectral
