#pragma once

#include <Eigen/Core>

namespace spectral {

// Eigen's solvers of dense symmetric matrices, compiled here alone: each takes the compiler six
// seconds in every file that names it.

struct Eigenpairs {
    Eigen::VectorXd values;   ///< k.
    Eigen::MatrixXd vectors;  ///< n x k, orthonormal.
};

/// All eigenpairs of a symmetric matrix, by ascending value.
///
/// @param A  n x n, of which the lower triangle is read.
/// @throws SolverFailure  when the iteration does not converge.
Eigenpairs symmetricPairs(const Eigen::MatrixXd& A);

/// The same of a tridiagonal matrix, whose entries should be about 1.
///
/// @param diagonal   n.
/// @param off        n - 1.
Eigenpairs tridiagonalPairs(const Eigen::VectorXd& diagonal, const Eigen::VectorXd& off);

/// The x of least x^T A x / x^T B x.
///
/// @param A, B  n x n, symmetric; B positive definite.
/// @return      n, with x^T B x = 1.
Eigen::VectorXd leastQuotient(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

/// The solution of A x = b without the directions in which A is singular: that of least norm.
///
/// @param A         n x n, symmetric and positive semidefinite.
/// @param singular  eigenvalues up to this one are 0, relative to the largest.
/// @throws SolverFailure  as symmetricPairs.
Eigen::VectorXd leastNormSolution(const Eigen::MatrixXd& A, const Eigen::VectorXd& b,
                                  double singular);

}  // namespace spectral
