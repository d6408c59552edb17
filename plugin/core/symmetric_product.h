#pragma once

#include <Eigen/Core>

#include "laplacian.h"
#include "types.h"

namespace spectral {

/// W S, for a symmetric sparse W (n x n) and S (n x m).
///
/// @param W  compressed.
Eigen::MatrixXd symmetricProduct(const SparseMatrix& W, const Eigen::Ref<const Eigen::MatrixXd>& S);

/// |D^-1/2 (W s_j - lambda_j D s_j)|^2 of each column s_j of S: squares of the residuals of
/// W s = lambda D s in the norm that does not depend on the mesh's density.
Eigen::VectorXd squaredResiduals(const Laplacian& laplacian,
                                 const Eigen::Ref<const Eigen::MatrixXd>& S,
                                 const Eigen::Ref<const Eigen::VectorXd>& lambda);

}  // namespace spectral
