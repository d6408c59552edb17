#pragma once

#include <cstddef>

namespace spectral {

/// A dense symmetric matrix of which the first rows and columns are eliminated: its lower half,
/// column by column, as it lies in memory.
struct DenseFront {
    std::ptrdiff_t width = 0;  ///< Columns to eliminate.
    std::ptrdiff_t below = 0;  ///< The others.

    /// The columns to eliminate, each `stride` numbers after the one before. Their rows begin
    /// `offset` numbers from its beginning, so that those below begin at a multiple of kFrontLane;
    /// so many numbers there are for them, too. The numbers before and after the rows are 0.
    double* panel = nullptr;
    std::ptrdiff_t stride = 0, offset = 0;

    /// The lower half of the others, which what is eliminated contributes to: `below` columns of
    /// stride - offset - width numbers each.
    double* update = nullptr;

    double* scratch = nullptr;  ///< width stride numbers.

    /// Does call(function, task) for all tasks from 0 to count - 1, on several threads perhaps;
    /// null: the elimination is not shared.
    void (*share)(std::ptrdiff_t count, void (*call)(const void* function, std::ptrdiff_t task),
                  const void* function) = nullptr;
};

/// The rows of a front come in so many at a time.
inline constexpr std::ptrdiff_t kFrontLane = 4;

/// Elimination within fronts, for the widest vector instructions that the processor has.
///
/// Pointers, not Eigen's types: see kernels.h.
struct FrontElimination {
    /// Replaces the panel by the columns of L, the diagonal by the pivots, and the update by the
    /// Schur complement. False when a pivot is 0.
    bool (*eliminate)(const DenseFront& front);
};

/// Chosen for this processor, once.
const FrontElimination& frontElimination();

}  // namespace spectral
