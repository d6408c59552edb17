#pragma once

#include <Eigen/Core>

#include "core/harmonics/spectrum_slicing.h"
#include "core/laplacian/laplacian.h"
#include "core/ldlt/shifted_ldlt.h"
#include "core/support/threads.h"

namespace spectral {

/// The eigenpairs in an interval of the spectrum.
struct IntervalPairs {
    Eigen::MatrixXd Phi;     ///< n x count, D-orthonormal; empty where they were not found.
    Eigen::VectorXd lambda;  ///< count, ascending.

    bool isComplete() const { return Phi.cols() > 0; }
};

/// All eigenpairs in an interval, by Spectra's implicitly restarted Lanczos method for
/// (W - sigma D)^-1 D with sigma in the middle of the interval.
///
/// A single Lanczos run finds one copy of a multiple eigenvalue, and may miss pairs at the ends of
/// the interval: while fewer are found than the interval must hold, further runs follow on the
/// complement of the pairs already known.
///
/// @param factor  scratch; on return of W - sigma D.
/// @return incomplete where an end of the interval lies on an eigenvalue, which then counts to both
///         sides or to none.
/// @throws SolverFailure  when Spectra does not converge; whatever the stop point throws.
IntervalPairs computeInterval(const Laplacian& laplacian, const SpectralInterval& interval,
                              ShiftedLdlt& factor, const StopPoint& stopPoint);

/// D-orthonormalizes the columns of U, also against those of `known`, which are D-orthonormal.
///
/// @return the smallest part of a unit vector that the others have left: 0 where U is linearly
///         dependent, and then meaningless. Below kOwnPart, U has a column of `known` again.
double orthonormalize(const Eigen::VectorXd& D, const Eigen::Ref<const Eigen::MatrixXd>& known,
                      Eigen::Ref<Eigen::MatrixXd> U);
inline constexpr double kOwnPart = 0.5;

}  // namespace spectral
