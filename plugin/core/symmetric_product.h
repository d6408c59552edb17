#pragma once

#include <Eigen/Core>

#include "types.h"

namespace spectral {

/// W S, for a symmetric sparse W (n x n) and S (n x m).
///
/// Several columns at a time: an entry of W is then fetched once for all of them, and so is a line
/// of the cache. As W is symmetric its columns serve as rows, so that each result is written once.
///
/// @param W  compressed.
Eigen::MatrixXd symmetricProduct(const SparseMatrix& W, const Eigen::Ref<const Eigen::MatrixXd>& S);

}  // namespace spectral
