#pragma once

#include <cstddef>

namespace spectral {

/// A symmetric sparse matrix as it lies in memory, n x n, compressed.
struct SymmetricSparse {
    std::ptrdiff_t n = 0;
    const int* starts = nullptr;  ///< n + 1: where the columns begin in `rows` and `values`.
    const int* rows = nullptr;
    const double* values = nullptr;
};

/// Products with a symmetric sparse matrix, for the widest vector instructions that the processor
/// has. Pointers, not Eigen's types: see dense_products.cpp.
struct SparseProducts {
    /// WS = W S: S and WS n x columns, column-major; `stride` is the distance of columns.
    void (*product)(const SymmetricSparse& W, const double* S, std::ptrdiff_t strideS,
                    std::ptrdiff_t columns, double* WS, std::ptrdiff_t strideWS);

    /// squares[j] = |D^-1/2 (W s_j - lambda[j] D s_j)|^2 of each column s_j of S: D has n masses.
    void (*squaredResiduals)(const SymmetricSparse& W, const double* D, const double* S,
                             std::ptrdiff_t strideS, std::ptrdiff_t columns, const double* lambda,
                             double* squares);
};

/// Chosen for this processor, once.
const SparseProducts& sparseProducts();

}  // namespace spectral
