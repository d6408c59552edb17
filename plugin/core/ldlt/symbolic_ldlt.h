#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/support/types.h"

namespace spectral {

/// The symbolic analysis of LDL^T factorizations of matrices with the pattern of W. The factor's
/// rows and columns are those of W in a fill-reducing order (approximate minimum degree), in which
/// every subtree of the elimination tree is contiguous.
///
/// Consecutive columns of L with the same rows below them, or nearly the same (a relaxed
/// supernode), are eliminated together in a dense frontal matrix (ldlt_elimination.h) and stored
/// with the same rows: a few stored entries of L are 0.
struct SymbolicLdlt {
    /// @param W        n x n, symmetric, both triangles stored.
    /// @param similar  analysis of a pattern that differs in a few per cent of its entries; its
    ///                 order is adapted if this adds hardly any entries to L. May be null.
    /// @throws SolverFailure  when the factor has more entries than an int can count: some 1e7
    /// rows.
    explicit SymbolicLdlt(const SparseMatrix& W, const SymbolicLdlt* similar = nullptr);

    /// Whether W has the analyzed pattern.
    bool hasPatternOf(const SparseMatrix& W) const;

    std::vector<int> starts, rows;  ///< The pattern of W: compressed columns.
    Eigen::VectorXi order;          ///< n: row i of W is row order[i] of the factor.
    std::vector<int> inverse;       ///< n: row j of the factor is row inverse[j] of W.

    /// A supernode and its frontal matrix, whose rows are those of its columns and those below.
    struct Front {
        int first = 0, width = 0;  ///< First column and number of columns.
        int below = 0;             ///< Number of rows below the columns.

        /// Number of its entries of L, including the diagonal.
        Index size() const { return Index{width} * (width + 1) / 2 + Index{width} * below; }
        int firstRow = 0;    ///< Index into `frontRows`: start of its rows, ascending.
        int firstPlace = 0;  ///< Index into `places`: positions, in its parent, of its rows below.
        int children = 0;    ///< Number of children: fronts whose first row below is one of its
                             ///< columns. All their rows below are rows of this front.
        int entriesBegin = 0, entriesEnd = 0;  ///< Range of `entries`.
    };
    /// In postorder: a front's children are the last fronts before it that have no parent yet.
    std::vector<Front> fronts;
    std::vector<int> frontRows, places;

    std::vector<int> valueStarts;  ///< n + 1: start of the values of each column of L.
    std::vector<int> rowStarts;    ///< n: start of its rows below the diagonal, in `frontRows`.
    std::vector<char> joined;      ///< n: whether the next column is in the same supernode.

    /// A subtree of the elimination tree, processed in parallel with other subtrees. Its columns
    /// are contiguous; the only other rows it updates are those below the columns of its root.
    struct Subtree {
        int firstFront = 0, endFront = 0;    ///< Range of fronts; the last one is the root.
        int firstColumn = 0, endColumn = 0;  ///< Range of columns of the factor.
        int firstCopy = 0;                   ///< Index into `copied`: the rows below the root.
    };
    /// Disjoint and ascending; fronts outside of them are eliminated serially. They depend on the
    /// pattern alone, so results do not depend on the number of threads.
    std::vector<Subtree> subtrees;

    /// Indices of the subtrees by descending size: taken in this order, threads finish together.
    std::vector<int> largestFirst;

    /// Solves work on n + copied.size() rows: each subtree has its own copies of the rows it shares
    /// with others. Row n + k is a copy of row copied[k]; `solveRows` are `frontRows` with the
    /// indices of the copies.
    std::vector<int> copied, solveRows;

    /// An entry of the lower triangle of W, located in the front of its column.
    struct Entry {
        int source = 0;           ///< Index into the values of W.
        int row = 0, column = 0;  ///< Position in the front.
    };
    std::vector<Entry> entries;

  private:
    /// The elimination tree (parent -1 for roots), and the number of entries below the diagonal in
    /// each column of L, without relaxation.
    struct Columns {
        std::vector<int> parent, count;
    };
    Columns findOrder(const SparseMatrix& W, const SymbolicLdlt* similar);
    void adaptOrder(const SymbolicLdlt& similar);
    void findClosedRows();
    Columns eliminationTree();                    ///< The tree for the current order.
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

    double entriesWhenOrdered_ = 0.0;  // off-diagonal entries of L for the pattern that was ordered
    std::vector<int> frontOf_;         // n: front of each column
    std::vector<int> parentFront_;     // parent of each front, or -1
};

}  // namespace spectral
