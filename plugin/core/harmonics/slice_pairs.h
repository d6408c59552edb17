#pragma once

#include <Eigen/Core>

#include "core/harmonics/spectrum_slicing.h"
#include "core/laplacian/constant_modes.h"
#include "core/laplacian/laplacian.h"
#include "core/ldlt/shifted_ldlt.h"
#include "core/support/parallel_tasks.h"

namespace spectral {

/// The eigenpairs of a slice of the spectrum.
struct SlicePairs {
    Eigen::MatrixXd Phi;     ///< n x count, D-orthonormal; empty where they were not found.
    Eigen::VectorXd lambda;  ///< count, ascending.

    bool isComplete() const { return Phi.cols() > 0; }
};

/// All eigenpairs of a slice, by Spectra's implicitly restarted Lanczos method for
/// (W - sigma D)^-1 D, sigma in the middle of the slice.
///
/// A single run finds one copy of a multiple eigenvalue, and may miss pairs at the ends of the
/// slice: as long as fewer are found than the slice must hold, further runs follow on the
/// complement of the pairs that are known.
///
/// @param factor  for use; on return of W - sigma D.
/// @return incomplete where an end of the slice has met an eigenvalue, which then counts to both
///         sides or none.
/// @throws SolverFailure  when Spectra does not converge; whatever the stop point throws.
SlicePairs computeSlice(const Laplacian& laplacian, const ConstantModes& constants,
                        const SpectrumSlice& slice, ShiftedLdlt& factor,
                        const StopPoint& stopPoint);

/// D-orthonormalizes the columns of U on the complement of those of `known`, which are
/// D-orthonormal. Returns the least part that the others have left of a unit vector: 0 where U is
/// dependent, and without meaning then; below kOwnPart it holds one of `known` again.
double orthonormalize(const Eigen::VectorXd& D, const Eigen::Ref<const Eigen::MatrixXd>& known,
                      Eigen::Ref<Eigen::MatrixXd> U);
inline constexpr double kOwnPart = 0.5;

}  // namespace spectral
