#include "core/support/dense_solvers.h"

#include <Eigen/Eigenvalues>
#include <string>

#include "core/support/errors.h"

namespace spectral {

namespace {

using Solver = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>;

Eigenpairs pairsOf(const Solver& solver, Eigen::Index n) {
    if (solver.info() != Eigen::Success)
        throw SolverFailure("the dense eigensolver did not converge for " + std::to_string(n) +
                            " rows");
    return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace

Eigenpairs symmetricPairs(const Eigen::MatrixXd& A) { return pairsOf(Solver(A), A.rows()); }

Eigenpairs tridiagonalPairs(const Eigen::VectorXd& diagonal, const Eigen::VectorXd& off) {
    Solver solver;
    solver.computeFromTridiagonal(diagonal, off);
    return pairsOf(solver, diagonal.size());
}

Eigen::VectorXd leastQuotient(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
    return Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(A, B).eigenvectors().col(0);
}

Eigen::VectorXd leastNormSolution(const Eigen::MatrixXd& A, const Eigen::VectorXd& b,
                                  double singular) {
    const auto [lambda, Q] = symmetricPairs(A);
    const Eigen::VectorXd inverse =
        (lambda.array() > singular * lambda.maxCoeff()).select(lambda.cwiseInverse(), 0.0);
    return Q * (inverse.asDiagonal() * (Q.transpose() * b));
}

}  // namespace spectral
