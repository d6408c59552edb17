#pragma once

#include <cstddef>
#include <vector>

namespace spectral {

/// The rows of a frontal matrix are padded to multiples of this many.
inline constexpr std::ptrdiff_t kLane = 4;

/// A frontal matrix of the multifrontal method: a dense symmetric matrix whose first rows and
/// columns, the pivot columns, are to be eliminated. The lower triangle is stored column-major.
struct FrontalMatrix {
    std::ptrdiff_t width = 0;  ///< Number of pivot columns.
    std::ptrdiff_t below = 0;  ///< Number of the other columns.

    /// The pivot columns, `stride` numbers apart. Each starts with `offset` zeros, so that the rows
    /// below the pivots start at a multiple of kLane, and is padded with zeros at its end.
    double* columns = nullptr;
    std::ptrdiff_t stride = 0, offset = 0;

    /// The contribution block: `below` columns of contributionStride() numbers each.
    double* contribution = nullptr;
    std::ptrdiff_t contributionStride() const { return stride - offset - width; }

    double* scratch = nullptr;  ///< width * stride numbers.

    /// Calls call(function, task) for all tasks below `count`, possibly on several threads.
    void (*parallelFor)(std::ptrdiff_t count,
                        void (*call)(const void* function, std::ptrdiff_t task),
                        const void* function) = nullptr;
};

/// L of a sparse factorization P A P^T = L D L^T, stored by columns. Its unit diagonal is implicit.
struct LdltFactor {
    const int* starts = nullptr;     ///< n + 1: start of each column in `values`.
    const int* rowStarts = nullptr;  ///< n: start of each column in `rows`.
    const int* rows = nullptr;       ///< Row indices, ascending within a column.
    const double* values = nullptr;
    const char* joined = nullptr;  ///< n: whether columns j and j + 1 belong to one supernode: the
                                   ///< rows of column j are j + 1 and those of column j + 1.
};

/// Maximum number of right-hand sides of a triangular solve.
inline constexpr int kMaxRightHandSides = 8;

/// The inner loops of a factorization and its solves, compiled for one instruction set.
///
/// Right-hand sides: in the order of the factor, row-major, 1 to 4 columns, or kMaxRightHandSides.
struct Kernels {
    /// Replaces the pivot columns with those of L, with the pivots on the diagonal, and the
    /// contribution block with the Schur complement. False when a pivot is 0.
    bool (*eliminateFront)(const FrontalMatrix& front);

    /// Y <- L^-1 Y, restricted to columns `begin` to `end` - 1 of L, which are whole supernodes.
    void (*forward)(const LdltFactor& factor, double* Y, int columns, std::ptrdiff_t begin,
                    std::ptrdiff_t end);

    /// Y <- L^-T Y, restricted likewise.
    void (*backward)(const LdltFactor& factor, double* Y, int columns, std::ptrdiff_t begin,
                     std::ptrdiff_t end);
};

/// The kernels that this processor can run, fastest first.
const std::vector<Kernels>& availableKernels();

/// The fastest available kernels.
inline const Kernels& kernels() {
    static const Kernels& fastest = availableKernels().front();
    return fastest;
}

}  // namespace spectral
