#pragma once

#include <Eigen/Core>
#include <vector>

#include "types.h"

namespace spectral {

/// What all LDL^T factorizations of matrices with the pattern of W have in common: nothing here
/// depends on their numbers. The rows and columns of the factor are those of W in another order,
/// which keeps it sparse, and in which every subtree of the elimination tree is in one piece.
///
/// Successive columns of L that have the same rows below them, or nearly so (a relaxed supernode),
/// are eliminated together in a small dense matrix, their front (ldlt_elimination.h), and have the
/// same rows below in L: a few of its entries are 0.
struct SymbolicLdlt {
    /// @param W  n x n, symmetric, both halves stored.
    /// @throws InvalidMesh  when the factor has more entries than an int counts: some 1e7 vertices.
    explicit SymbolicLdlt(const SparseMatrix& W);

    /// None, of no matrix.
    SymbolicLdlt() = default;

    /// Whether W has the pattern that was analyzed.
    bool isOf(const SparseMatrix& W) const;

    std::vector<int> starts, rows;  ///< The pattern, as W has it.
    Eigen::VectorXi order;          ///< n: row i of W is row order[i] of the factor,
    std::vector<int> inverse;       ///< n: and row j of the factor is row inverse[j] of W.

    /// The columns of a supernode, and the rows of its front: these, then those below them.
    struct Front {
        int first = 0, width = 0;  ///< The columns.
        int below = 0;             ///< Number of the rows below.
        int firstRow = 0;          ///< In `frontRows`: where its rows are, ascending.
        int firstPlace = 0;        ///< In `places`: where its rows below are in its parent's front.
        int children = 0;          ///< Fronts whose first row below is one of its columns: it has
                                   ///< all of their rows below.
        int entriesBegin = 0, entriesEnd = 0;  ///< In `entries`.
    };
    /// Each after its children: of those before that are nobody's yet, the last ones.
    std::vector<Front> fronts;
    std::vector<int> frontRows, places;

    std::vector<int> valueStarts;  ///< n + 1: where the values of a column of L begin,
    std::vector<int> rowStarts;    ///< n: and its rows in `frontRows`, all below the diagonal.
    std::vector<char> joined;      ///< n: whether the next column is in the same supernode.

    /// An entry of the lower half of W in the front of its column.
    struct Entry {
        int source = 0;  ///< Its place among the values of W.
        int row = 0, column = 0;
    };
    std::vector<Entry> entries;

  private:
    /// Of each column of L, without the zeros of relaxed supernodes: the first row below the
    /// diagonal, or -1 (the elimination tree); and the number of rows below it.
    struct Columns {
        std::vector<int> parent, count;
    };
    Columns findOrder(const SparseMatrix& W);
    void findFronts(const Columns& columns);
    void findRows(const Columns& columns);
    void findPlaces();

    std::vector<int> frontOf_;  // n: of a column
};

}  // namespace spectral
