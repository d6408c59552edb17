#pragma once

#include <Eigen/Core>

#include "types.h"

namespace spectral {

/// W S, for a symmetric sparse W (n x n) and S (n x m).
///
/// @param W  compressed.
Eigen::MatrixXd symmetricProduct(const SparseMatrix& W, const Eigen::Ref<const Eigen::MatrixXd>& S);

}  // namespace spectral
