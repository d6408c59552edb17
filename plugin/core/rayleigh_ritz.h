#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "laplacian.h"
#include "progress.h"

namespace spectral {

/// The Rayleigh-Ritz procedure on the span of the columns of S: its best approximations of
/// eigenpairs of W phi = lambda D phi, all at once.
///
/// Solves S^T W S z = theta S^T D S z, and replaces the first columns of S by S Z, in place: beside
/// S no second matrix of its size is needed. Works on all cores; the result does not depend on
/// their number. The cost is 4 n m^2 floating-point operations.
///
/// @param S       n x m, of full rank; on return its first columns are the Ritz vectors of the
///                lowest Ritz values, D-orthonormal, and the others without meaning.
/// @param order   n: the rows of W, neighbours close to each other as in a factorization
///                (ShiftedLdlt::order): a matter of speed, not of the result.
/// @param wanted  how many these are, at most m: asked by another core while one solves the small
///                problem, which takes as long as a factorization.
/// @return their Ritz values, ascending.
/// @throws SolverFailure  when the columns are dependent to working precision; Cancelled, and
///         whatever `wanted` throws.
Eigen::VectorXd rayleighRitz(const Laplacian& laplacian, Eigen::Ref<Eigen::MatrixXd> S,
                             const std::vector<int>& order, const std::function<Index()>& wanted,
                             const Progress& progress);

}  // namespace spectral
