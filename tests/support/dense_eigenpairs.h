#pragma once

#include <Eigen/Core>

namespace spectral::testing {

/// All eigenpairs of A x = lambda D x, by Eigen's dense solver.
struct DenseEigenpairs {
    Eigen::VectorXd values;   ///< n, ascending.
    Eigen::MatrixXd vectors;  ///< n x n, D-orthonormal columns.
};

/// @param A  n x n, symmetric.
/// @param D  n diagonal entries > 0.
DenseEigenpairs denseEigenpairs(const Eigen::MatrixXd& A, const Eigen::VectorXd& D);

/// The eigenvalues of A, ascending.
inline Eigen::VectorXd denseEigenvalues(const Eigen::MatrixXd& A) {
    return denseEigenpairs(A, Eigen::VectorXd::Ones(A.rows())).values;
}

/// X with A X = B, for A positive semidefinite and B orthogonal to its kernel; so is X.
Eigen::MatrixXd denseSolution(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

}  // namespace spectral::testing
