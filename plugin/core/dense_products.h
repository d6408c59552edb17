#pragma once

#include <cstddef>

namespace spectral {

/// Products of tall matrices, for the widest vector instructions that the processor has.
///
/// Matrices are column-major; `stride` is the distance of columns. Pointers, not Eigen's types:
/// those of one instruction set are none of another's business (see dense_products.cpp).
struct DenseProducts {
    /// C = A^T B: A n x p, B n x q, C p x q.
    void (*transposedProduct)(const double* A, std::ptrdiff_t strideA, const double* B,
                              std::ptrdiff_t strideB, double* C, std::ptrdiff_t strideC,
                              std::ptrdiff_t n, std::ptrdiff_t p, std::ptrdiff_t q);

    /// The upper half of C = A^T B, with its diagonal: A and B n x m, C m x m.
    void (*upperTransposedProduct)(const double* A, std::ptrdiff_t strideA, const double* B,
                                   std::ptrdiff_t strideB, double* C, std::ptrdiff_t strideC,
                                   std::ptrdiff_t n, std::ptrdiff_t m);

    /// C = A B: A n x p, B p x q, C n x q, which is none of the others.
    void (*product)(const double* A, std::ptrdiff_t strideA, const double* B,
                    std::ptrdiff_t strideB, double* C, std::ptrdiff_t strideC, std::ptrdiff_t n,
                    std::ptrdiff_t p, std::ptrdiff_t q);
};

/// Chosen for this processor, once.
const DenseProducts& denseProducts();

}  // namespace spectral
