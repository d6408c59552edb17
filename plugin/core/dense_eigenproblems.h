#pragma once

#include <cstddef>

namespace spectral {

/// Small dense symmetric eigenproblems, for the widest vector instructions that the processor has.
///
/// Matrices are m x m, column-major without gaps; of A and B the lower halves are read. Pointers,
/// not Eigen's types: those of one instruction set are none of another's business (see
/// dense_products.cpp).
struct DenseEigenproblems {
    /// A Z = Z diag(values), Z^T Z = I, values ascending. Returns whether that converged.
    bool (*symmetric)(const double* A, std::ptrdiff_t m, double* values, double* Z);

    /// A Z = B Z diag(values), Z^T B Z = I, values ascending. Returns whether B is
    /// positive definite to working precision, and that converged with finite Z.
    bool (*generalized)(const double* A, const double* B, std::ptrdiff_t m, double* values,
                        double* Z);
};

/// Chosen for this processor, once.
const DenseEigenproblems& denseEigenproblems();

}  // namespace spectral
