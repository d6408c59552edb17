#include "core/krylov/tridiagonal.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "core/support/errors.h"

namespace spectral {

TridiagonalEigenpairs eigenpairsOfTridiagonal(const std::vector<double>& diagonal,
                                              const std::vector<double>& beside) {
    const auto m = static_cast<Eigen::Index>(diagonal.size());
    Eigen::VectorXd a = Eigen::Map<const Eigen::VectorXd>(diagonal.data(), m);
    Eigen::VectorXd b = Eigen::Map<const Eigen::VectorXd>(beside.data(), m - 1);
    // Eigen scales a full matrix to entries up to 1, but not a tridiagonal one, while its test for
    // convergence, |b| <= eps sqrt(|a|), is made for that scale only.
    const double scale = std::max(a.cwiseAbs().maxCoeff(), m > 1 ? b.cwiseAbs().maxCoeff() : 0.0);
    if (scale > 0.0) {
        a /= scale;
        b /= scale;
    }
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
    solver.computeFromTridiagonal(a, b);
    if (solver.info() != Eigen::Success)
        throw SolverFailure("the tridiagonal eigenproblem of the Krylov space did not converge");
    return {scale * solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace spectral
