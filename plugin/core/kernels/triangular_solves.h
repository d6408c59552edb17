#pragma once

#include <cstddef>

namespace spectral {

/// A sparse LDL^T factorization P A P^T = L D L^T, as it lies in memory.
struct LdltFactor {
    const int* starts = nullptr;     ///< n + 1: where the values of each column of L begin; the
                                     ///< diagonal of ones is not stored.
    const int* rowStarts = nullptr;  ///< n: where its rows begin, ascending.
    const int* rows = nullptr;
    const double* values = nullptr;
    const char* joined = nullptr;  ///< n: whether column j + 1 of L has all rows of column j but
                                   ///< the first, which is j + 1; 0 for the last.
};

/// The largest number of right-hand sides of a solve: as many as fit into the widest registers.
inline constexpr int kMostRightHandSides = 16;

/// Parts of solves with a sparse factorization, for the widest vector instructions that the
/// processor has.
///
/// Right-hand sides are in the order of the factor, those of a row next to each other: 1, 2, 3, 4,
/// 8 or kMostRightHandSides.
///
/// Pointers, not Eigen's types: see kernels.h.
struct TriangularSolves {
    /// Y <- L^-1 Y, the part that columns `begin` to `end` - 1 of L do. All of the columns of a
    /// supernode are among them, or none.
    void (*eliminate)(const LdltFactor& factor, double* Y, int columns, std::ptrdiff_t begin,
                      std::ptrdiff_t end);

    /// Y <- L^-T Y, the same.
    void (*substitute)(const LdltFactor& factor, double* Y, int columns, std::ptrdiff_t begin,
                       std::ptrdiff_t end);
};

/// Chosen for this processor, once.
const TriangularSolves& triangularSolves();

}  // namespace spectral
