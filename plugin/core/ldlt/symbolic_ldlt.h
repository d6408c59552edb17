#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/support/types.h"

namespace spectral {

/// The symbolic analysis of LDL^T factorizations of matrices with the pattern of W. The factor's
/// rows and columns are those of W in a fill-reducing order (approximate minimum degree), in which
/// every subtree of the elimination tree is contiguous.
///
/// Successive columns of L with the same rows below them, or nearly so (a relaxed supernode), are
/// eliminated together in a dense frontal matrix (ldlt_elimination.h), and stored with the same
/// rows: a few entries of L are 0.
struct SymbolicLdlt {
    /// @param W        n x n, symmetric, both triangles stored.
    /// @param similar  of a pattern that differs in a few per cent of its entries, whose order is
    ///                 adapted if L has hardly more entries with it; or null.
    /// @throws SolverFailure  when the factor has more entries than an int counts: some 1e7 rows.
    explicit SymbolicLdlt(const SparseMatrix& W, const SymbolicLdlt* similar = nullptr);

    /// Whether W has the pattern that was analyzed.
    bool isOf(const SparseMatrix& W) const;

    std::vector<int> starts, rows;  ///< The pattern of W: compressed columns.
    Eigen::VectorXi order;          ///< n: row i of W is row order[i] of the factor.
    std::vector<int> inverse;       ///< n: row j of the factor is row inverse[j] of W.

    /// A supernode, and its frontal matrix: the rows of its columns, then those below them.
    struct Front {
        int first = 0, width = 0;  ///< The columns.
        int below = 0;             ///< Number of the rows below.

        /// Number of its entries of L, including the diagonal.
        Index size() const { return Index{width} * (width + 1) / 2 + Index{width} * below; }
        int firstRow = 0;    ///< In `frontRows`: where its rows are, ascending.
        int firstPlace = 0;  ///< In `places`: the positions of its rows below in its parent.
        int children = 0;    ///< Number of its children: fronts whose first row below is one of
                             ///< its columns. It has all of their rows below.
        int entriesBegin = 0, entriesEnd = 0;  ///< In `entries`.
    };
    /// In postorder: the children of a front are the last ones before it that have no parent yet.
    std::vector<Front> fronts;
    std::vector<int> frontRows, places;

    std::vector<int> valueStarts;  ///< n + 1: where the values of each column of L start.
    std::vector<int> rowStarts;    ///< n: where its rows below the diagonal start, in `frontRows`.
    std::vector<char> joined;      ///< n: whether the next column is in the same supernode.

    /// A subtree of the elimination tree, which is factorized and solved with in parallel with
    /// other subtrees: its columns are contiguous, and it contributes to other rows only in the
    /// rows below the columns of its root.
    struct Subtree {
        int firstFront = 0, endFront = 0;    ///< The last is its root.
        int firstColumn = 0, endColumn = 0;  ///< Of the factor.
        int firstCopy = 0;                   ///< In `copied`: the rows below its root's columns.
    };
    /// Disjoint and ascending; the fronts in none of them are eliminated serially. They depend on
    /// the pattern alone, so that results are the same for any number of threads.
    std::vector<Subtree> subtrees;

    /// The subtrees' numbers by descending size of L: threads that take them in this order end
    /// together.
    std::vector<int> largestFirst;

    /// Solves work on n + copied.size() rows: each subtree has its own copies of the rows that it
    /// shares with others. Row n + k is a copy of row copied[k]; `solveRows` are `frontRows` with
    /// the copies' numbers.
    std::vector<int> copied, solveRows;

    /// An entry of the lower triangle of W, in the front of its column.
    struct Entry {
        int source = 0;  ///< Index into the values of W.
        int row = 0, column = 0;
    };
    std::vector<Entry> entries;

  private:
    /// The elimination tree (-1 for roots), and the number of rows below the diagonal of each
    /// column of L without relaxation.
    struct Columns {
        std::vector<int> parent, count;
    };
    Columns findOrder(const SparseMatrix& W, const SymbolicLdlt* similar);
    void adaptOrder(const SymbolicLdlt& similar);
    void findClosedRows();
    Columns eliminationTree();                    ///< In the order as it is.
    Columns postordered(const Columns& columns);  ///< Makes the order a postorder of the tree.
    void findFronts(const Columns& columns);
    void findSubtrees();
    void findRows();
    void setPositions(const Front& front, std::vector<int>& position) const;
    void findEntries();
    void findPlaces();
    void findCopies();
    template <class Work>
    void forRows(const Work& work) const;

    Index entriesWhenOrdered_ = 0;  // off the diagonal of L, of the pattern the order was made for
    std::vector<int> frontOf_;      // n, of each column
    std::vector<int> parentFront_;  // of each front, or -1
};

}  // namespace spectral
