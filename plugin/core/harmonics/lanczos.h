#pragma once

#include <Eigen/Core>
#include <functional>

#include "core/support/dense_solvers.h"
#include "core/support/types.h"

namespace spectral {

/// A symmetric operator on vectors of n numbers. It may throw.
using SymmetricOperator = std::function<Eigen::VectorXd(const Eigen::Ref<const Eigen::VectorXd>&)>;

struct LanczosOptions {
    Index dimension = 0;     ///< Dimension of the Krylov space, wanted < dimension <= n.
    int maxRestarts = 0;     ///< Maximum number of restarts, >= 1.
    double tolerance = 0.0;  ///< Relative error of the eigenvalues, which should be about 1.
};

/// The eigenpairs of largest modulus, by Spectra's implicitly restarted Lanczos method.
///
/// @param wanted  number of pairs, 1 <= wanted < n.
/// @return at least one pair, by descending modulus; fewer than wanted if the others have not
///         converged.
/// @throws SolverFailure  when none converges, or Spectra breaks down.
/// @throws whatever the operator throws.
Eigenpairs largestPairs(const SymmetricOperator& S, Index n, Index wanted,
                        const LanczosOptions& options);

}  // namespace spectral
