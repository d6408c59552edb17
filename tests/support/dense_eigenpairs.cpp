#include "support/dense_eigenpairs.h"

#include <Eigen/Eigenvalues>

namespace spectral::testing {

DenseEigenpairs denseEigenpairs(const Eigen::MatrixXd& A, const Eigen::VectorXd& D) {
    const Eigen::VectorXd scale = D.cwiseSqrt().cwiseInverse();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scale.asDiagonal() * A *
                                                                scale.asDiagonal());
    return {solver.eigenvalues(), scale.asDiagonal() * solver.eigenvectors()};
}

}  // namespace spectral::testing
