#pragma once

#include <Eigen/Core>
#include <vector>

namespace spectral {

/// Eigenpairs of a symmetric tridiagonal matrix T, as a Lanczos recurrence makes them.
struct TridiagonalEigenpairs {
    Eigen::VectorXd values;   ///< m, ascending.
    Eigen::MatrixXd vectors;  ///< m x m, orthonormal columns.
};

/// @param diagonal  m entries of T, m >= 1.
/// @param beside    at least m - 1 entries beside the diagonal.
/// @throws SolverFailure  when the QR iteration does not converge: an entry is not finite.
TridiagonalEigenpairs eigenpairsOfTridiagonal(const std::vector<double>& diagonal,
                                              const std::vector<double>& beside);

}  // namespace spectral
