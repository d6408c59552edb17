#include "support/dense_eigenpairs.h"

#include <Eigen/Eigenvalues>

namespace spectral::testing {

DenseEigenpairs denseEigenpairs(const Eigen::MatrixXd& A, const Eigen::VectorXd& D) {
    const Eigen::VectorXd scale = D.cwiseSqrt().cwiseInverse();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scale.asDiagonal() * A *
                                                                scale.asDiagonal());
    return {solver.eigenvalues(), scale.asDiagonal() * solver.eigenvectors()};
}

Eigen::MatrixXd denseSolution(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
    constexpr double kRoundOff = 1e-12;
    const auto [lambda, Q] = denseEigenpairs(A, Eigen::VectorXd::Ones(A.rows()));
    const Eigen::ArrayXd inverse =
        (lambda.array() > kRoundOff * lambda.maxCoeff()).select(lambda.array().inverse(), 0.0);
    Eigen::MatrixXd X = Q.transpose() * B;
    X.array().colwise() *= inverse;
    return Q * X;
}

}  // namespace spectral::testing
