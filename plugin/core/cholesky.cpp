#include "cholesky.h"

#include <string>

#include "errors.h"

namespace spectral {

void ShiftedCholesky::factorize(const Laplacian& laplacian, double shift) {
    ++factorizations_;
    shift_ = shift;
    bool definite = false;
    try {
        ldlt_.factorize(laplacian, -shift);
        definite = ldlt_.eigenvaluesBelow() == 0;
    } catch (const SolverFailure&) {  // a pivot of zero
    }
    if (!definite)
        throw SolverFailure(
            "the sparse Cholesky factorization of W + s D (" + std::to_string(laplacian.W.rows()) +
            " vertices) broke down: the matrix is not positive definite to working precision, "
            "because triangles are degenerate or have collapsed. Apply 'Remove Zero Area Faces' or "
            "'Remeshing: Isotropic Explicit Remeshing' first");
}

Eigen::MatrixXd ShiftedCholesky::solve(const Eigen::MatrixXd& B) const {
    solves_ += static_cast<int>(B.cols());
    return ldlt_.solve(B);
}

void ShiftedCholesky::solveOrdered(double* Y, int columns) const {
    solves_ += columns;
    ldlt_.solveOrdered(Y, columns);
}

Index ShiftedCholesky::countEigenvaluesBelow(const Laplacian& laplacian, double sigma) {
    ++factorizations_;
    ShiftedLdlt ldlt;
    ldlt.factorize(laplacian, sigma);
    return ldlt.eigenvaluesBelow();
}

}  // namespace spectral
