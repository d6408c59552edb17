#pragma once

#include <Eigen/Core>
#include <vector>

#include "types.h"

namespace spectral {

/// What all LDL^T factorizations of matrices with the pattern of W have in common: nothing here
/// depends on their numbers. The rows and columns of the factor are those of W in another order,
/// which keeps it sparse, and in which every subtree of the elimination tree is in one piece.
///
/// Successive columns of L with the same rows below them (a supernode) are eliminated together, in
/// a small dense matrix: their front (ldlt_elimination.h).
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

    std::vector<int> factorStarts;  ///< n + 1: where the columns of L begin in `factorRows`.
    std::vector<int> factorRows;    ///< Ascending in each column, all below the diagonal.
    std::vector<char> joined;       ///< n: whether column j + 1 of L has all rows of column j but
                                    ///< the first, which is j + 1; 0 for the last.

    /// Rows and columns of a front: the columns of a supernode, then the rows below them.
    struct Front {
        int first = 0, width = 0;  ///< The columns.
        int below = 0;             ///< Number of the rows below: those of its last column of L.
        int children = 0;          ///< Fronts that have the first of their rows below here: all of
                                   ///< these rows are here, then.
        int firstPlace = 0;        ///< In `places`: where its rows below are in its parent's front.
        int entriesBegin = 0, entriesEnd = 0;  ///< In `entries`.
    };
    /// Each after its children: of those before that are nobody's yet, the last ones.
    std::vector<Front> fronts;
    std::vector<int> places;

    /// An entry of the lower half of W in the front of its column.
    struct Entry {
        int source = 0;  ///< Its place among the values of W.
        int row = 0, column = 0;
    };
    std::vector<Entry> entries;

  private:
    /// Sets the order and the numbers of rows. Returns the elimination tree: of each column the
    /// first row below its diagonal, or -1.
    std::vector<int> findOrder(const SparseMatrix& W);
    void findRows(const std::vector<int>& parent);
    void findFronts();

    std::vector<int> inverse_;  // n: row j of the factor is row inverse_[j] of W
};

}  // namespace spectral
