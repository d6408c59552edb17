#pragma once

#include <Eigen/Core>

#include "components.h"
#include "laplacian.h"
#include "parallel_tasks.h"
#include "shifted_ldlt.h"

namespace spectral {

/// What a block of vectors is turned towards: the eigenspaces of a slice of the spectrum, and away
/// from those beyond a bound above it.
struct Slice {
    double from = 0.0, to = 0.0;  ///< About the eigenvalues of the vectors.
    double bound = 0.0;           ///< > to.
    double damping = 1.0;  ///< What is beyond the bound is to lose so much beside the vectors: more
                           ///< where the bound is nearer than 0.

    double middle() const { return 0.5 * (from + to); }
};

/// Inverse iterations that a slice takes: the nearer its bound, and the more damping, the more.
int iterations(const Slice& slice);

/// Block inverse iteration with a Chebyshev filter: S <- p(M) S, M = (W - sigma D)^-1 D.
///
/// An eigenvector of lambda is multiplied by p(mu), mu = 1 / (lambda - sigma). Plain inverse
/// iteration has p = mu^d. Here p is the Chebyshev polynomial of the interval of all lambda above
/// the bound, 0 < mu < 1 / (bound - sigma), moved so that its least root is 0, the far end of the
/// spectrum. At the ends of the slice that is several times larger, beside its largest value
/// beyond the bound. Eigenvectors below the slice are left as they are: others look after them.
///
/// @param factor  of W - sigma D, sigma within the slice.
/// @param S       n x m, m <= n, independent; of any lengths, on return, too.
/// @throws SolverFailure  when the columns have become dependent; whatever the stop point throws.
void iterate(const Laplacian& laplacian, const ConstantModes& constants, const ShiftedLdlt& factor,
             const Slice& slice, Eigen::Ref<Eigen::MatrixXd> S, const StopPoint& stopPoint);

}  // namespace spectral
