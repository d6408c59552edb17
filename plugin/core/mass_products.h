#pragma once

#include <Eigen/Core>

namespace spectral {

/// A^T D B: the inner products of the columns of A (n x p) and B (n x q) in the masses D (n).
Eigen::MatrixXd innerProducts(const Eigen::Ref<const Eigen::MatrixXd>& A, const Eigen::VectorXd& D,
                              const Eigen::Ref<const Eigen::MatrixXd>& B);

/// S^T D S, in half the time of innerProducts(S, D, S).
Eigen::MatrixXd gramMatrix(const Eigen::Ref<const Eigen::MatrixXd>& S, const Eigen::VectorXd& D);

/// B <- B - A C, for A n x p, B n x q.
void subtractProduct(const Eigen::Ref<const Eigen::MatrixXd>& A, const Eigen::MatrixXd& C,
                     Eigen::Ref<Eigen::MatrixXd> B);

/// The first columns of A (n x p) <- A C, for C p x q, q <= p.
void multiplyInPlace(Eigen::Ref<Eigen::MatrixXd> A, const Eigen::MatrixXd& C);

}  // namespace spectral
