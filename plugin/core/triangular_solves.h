#pragma once

#include <cstddef>

namespace spectral {

/// A factorization P A P^T = L D L^T as it lies in memory, n x n.
struct LdltFactor {
    std::ptrdiff_t n = 0;
    const int* starts = nullptr;     ///< n + 1: where the columns of L begin in `values`.
    const int* rowStarts = nullptr;  ///< n: where their rows begin in `rows`.
    const int* rows = nullptr;       ///< Ascending in each column, all below the diagonal,
    const double* values = nullptr;  ///< whose ones are not stored.
    const double* pivots = nullptr;  ///< n entries of D, none of them 0.
    const char* joined = nullptr;    ///< n: whether column j + 1 of L has all rows of column j but
                                     ///< the first, which is j + 1; 0 for the last.
    const int* order = nullptr;      ///< n: row i of A is row order[i] of P A.
};

/// Solves with a sparse factorization, for the widest vector instructions that the processor has.
///
/// Pointers, not Eigen's types: those of one instruction set are none of another's business (see
/// dense_products.cpp).
struct TriangularSolves {
    /// X <- A^-1 diag(d) X - root X: d of n, X n x columns, column-major without gaps.
    void (*apply)(const LdltFactor& factor, const double* d, double root, double* X,
                  std::ptrdiff_t columns);
};

/// Chosen for this processor, once.
const TriangularSolves& triangularSolves();

}  // namespace spectral
