#include "core/ldlt/cholesky.h"

#include <string>

#include "core/mesh/mesh.h"
#include "core/support/errors.h"

namespace spectral {

void ShiftedCholesky::factorize(const Laplacian& laplacian, double shift) {
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

Index ShiftedCholesky::countEigenvaluesBelow(const Laplacian& laplacian, double sigma) {
    ShiftedLdlt ldlt = emptyFactor(laplacian);
    ldlt.factorize(laplacian, sigma);
    countWork(ldlt);
    return ldlt.eigenvaluesBelow();
}

}  // namespace spectral
