#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/support/types.h"

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

    /// Whether W has the pattern that was analyzed.
    bool isOf(const SparseMatrix& W) const;

    std::vector<int> starts, rows;  ///< The pattern, as W has it.
    Eigen::VectorXi order;          ///< n: row i of W is row order[i] of the factor,
    std::vector<int> inverse;       ///< n: and row j of the factor is row inverse[j] of W.

    /// The columns of a supernode, and the rows of its front: these, then those below them.
    struct Front {
        int first = 0, width = 0;  ///< The columns.
        int below = 0;             ///< Number of the rows below.

        /// Its entries of L, with the diagonal.
        Index size() const { return Index{width} * (width + 1) / 2 + Index{width} * below; }
        int firstRow = 0;    ///< In `frontRows`: where its rows are, ascending.
        int firstPlace = 0;  ///< In `places`: where its rows below are in its parent's front.
        int children = 0;    ///< Fronts whose first row below is one of its columns: it has
                             ///< all of their rows below.
        int entriesBegin = 0, entriesEnd = 0;  ///< In `entries`.
    };
    /// Each after its children: of those before that are nobody's yet, the last ones.
    std::vector<Front> fronts;
    std::vector<int> frontRows, places;

    std::vector<int> valueStarts;  ///< n + 1: where the values of a column of L begin,
    std::vector<int> rowStarts;    ///< n: and its rows in `frontRows`, all below the diagonal.
    std::vector<char> joined;      ///< n: whether the next column is in the same supernode.

    /// A part of the elimination tree that is eliminated, and solved with, beside the others: a
    /// front and all below it in the tree. Its columns are in one piece, and what it contributes to
    /// other rows is in the rows below its root's columns.
    struct Subtree {
        int firstFront = 0, endFront = 0;    ///< The last is its root.
        int firstColumn = 0, endColumn = 0;  ///< Of the factor.
        int firstCopy = 0;                   ///< In `copied`: the rows below its root's columns.
    };
    /// Disjoint, in their order; the fronts in none of them are eliminated one after the other.
    /// They depend on the pattern alone: what is computed is the same for any number of threads.
    std::vector<Subtree> subtrees;

    /// Solves work on vectors of n + copied.size() rows: a subtree has copies of its own of the
    /// rows that it shares with others. Row n + k is a copy of row copied[k], and `solveRows` are
    /// `frontRows` with the numbers of the copies.
    std::vector<int> copied, solveRows;

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
    void findSubtrees();

    std::vector<int> frontOf_;      // n: of a column
    std::vector<int> parentFront_;  // of a front, or -1
};

}  // namespace spectral
