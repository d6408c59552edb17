#pragma once

#include <Eigen/Core>

namespace spectral {

/// The inner products S^T D T of the columns of S (n x p) and T (n x q), by mass: p x q.
Eigen::MatrixXd innerProducts(const Eigen::Ref<const Eigen::MatrixXd>& S, const Eigen::VectorXd& D,
                              const Eigen::Ref<const Eigen::MatrixXd>& T);

/// T <- T - S (S^T D T): takes the part of the columns of T within the span of S away, S being
/// D-orthonormal.
void removePart(const Eigen::Ref<const Eigen::MatrixXd>& S, const Eigen::VectorXd& D,
                Eigen::Ref<Eigen::MatrixXd> T);

}  // namespace spectral
