#pragma once

#include <Eigen/Core>
#include <vector>

#include "types.h"

namespace spectral {

/// What all LDL^T factorizations of matrices with the pattern of W have in common: nothing here
/// depends on their numbers. The rows and columns of the factor are those of W in another order,
/// which keeps it sparse.
struct SymbolicLdlt {
    /// @param W  n x n, symmetric, both halves stored.
    /// @throws InvalidMesh  when the factor has more entries than an int counts: some 1e7 vertices.
    explicit SymbolicLdlt(const SparseMatrix& W);

    /// None, of no matrix.
    SymbolicLdlt() = default;

    /// Whether W has the pattern that was analyzed.
    bool isOf(const SparseMatrix& W) const;

    std::vector<int> starts, rows;  ///< The pattern, as W has it.
    Eigen::VectorXi order;          ///< n: row i of W is row order[i] of the factor.
    std::vector<int> parent;  ///< n, of the elimination tree: the first row of a column of L below
                              ///< its diagonal, or -1.
    std::vector<int> factorStarts;  ///< n + 1: where the columns of L begin, without diagonals.
    std::vector<char>
        joined;  ///< n: whether column j + 1 of L has all rows of column j but
                 ///< the first, which is j + 1 (they are in one supernode); 0 for the last.

    /// The upper half of the reordered W with its diagonal, column by column.
    std::vector<int> upperStarts;   ///< n + 1
    std::vector<int> upperRows;     ///< In no order within a column.
    std::vector<int> upperSources;  ///< Places of the entries among the values of W.
};

}  // namespace spectral
