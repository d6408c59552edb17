#pragma once

#include <Eigen/Core>
#include <functional>

#include "core/support/types.h"

namespace spectral {

/// A symmetric operator on vectors of n numbers. It may throw.
using SymmetricOperator = std::function<Eigen::VectorXd(const Eigen::Ref<const Eigen::VectorXd>&)>;

struct LanczosOptions {
    Index dimension = 0;     ///< Of the Krylov space, above the number of pairs wanted, up to n.
    int mostRestarts = 0;    ///< >= 1.
    double tolerance = 0.0;  ///< Of the eigenvalues, relative to those of about 1.
};

struct Eigenpairs {
    Eigen::VectorXd values;   ///< k, by descending modulus.
    Eigen::MatrixXd vectors;  ///< n x k, orthonormal.
};

/// The eigenpairs of largest modulus, by Spectra's implicitly restarted Lanczos method.
///
/// @param wanted  number of pairs, 1 <= wanted < n.
/// @return at least one pair; fewer than wanted where others have not converged.
/// @throws SolverFailure  when none converges, or Spectra breaks down.
/// @throws whatever the operator throws.
Eigenpairs largestPairs(const SymmetricOperator& S, Index n, Index wanted,
                        const LanczosOptions& options);

}  // namespace spectral
