#include "core/ldlt/symbolic_ldlt.h"

#include <Eigen/OrderingMethods>
#include <algorithm>
#include <cstdint>
#include <iterator>
#include <limits>
#include <numeric>
#include <string>

#include "core/support/errors.h"
#include "core/support/threads.h"

namespace spectral {

namespace {

/// Largest fraction of zeros in a relaxed supernode by its number of columns. Zeros cost memory,
/// but wide supernodes save indirect addressing, so narrow ones may have more. (As in CHOLMOD.)
struct Relaxation {
    Index width;
    double zeros;
};
constexpr Relaxation kRelaxations[] = {
    {4, 0.5}, {16, 0.2}, {48, 0.1}, {std::numeric_limits<Index>::max(), 0.05}};

/// A parallel subtree has at most 1 / kMinParts of the entries of L, so that several threads get
/// work and little remains above the subtrees, and at least 1 / kMaxParts, so that it is worth a
/// task. A factor with fewer than kMinShared entries is not split: a solve takes no longer than
/// waking a thread.
constexpr Index kMinParts = 4, kMaxParts = 200, kMinShared = 30000;

/// A range found before the tree is known has at most 1 / kClosedParts of all rows.
constexpr Index kClosedParts = 16;

/// The order of a similar pattern is reused while L has at most this many times the entries it had
/// for the pattern that was ordered: finding an order takes as long as a dozen solves.
constexpr double kMaxFill = 1.2;

/// Postorder of a forest: children before their parents, subtrees contiguous.
/// @param parent  parent of each node, a larger number; -1 for roots.
std::vector<int> postorder(const std::vector<int>& parent) {
    const auto n = static_cast<int>(parent.size());
    std::vector<int> size(parent.size(), 1);  // number of nodes of each subtree
    for (int i = 0; i < n; ++i)
        if (parent[i] >= 0) size[parent[i]] += size[i];
    // Subtrees fill their parent's range from the end; a node is the last of its own subtree.
    std::vector<int> number(parent.size()), next(parent.size());
    int end = n;
    for (int i = n - 1; i >= 0; --i) {
        int& last = parent[i] >= 0 ? next[parent[i]] : end;
        number[i] = last - 1;
        next[i] = last - 1;
        last -= size[i];
    }
    return number;
}

/// A supernode that may still absorb others.
struct Supernode {
    Index first = 0, width = 0, below = 0;
    Index zeros = 0;  // entries added to L by relaxation

    /// This supernode merged with its parent, whose first column follows its last.
    Supernode mergedWith(const Supernode& parent) const {
        const Index wider = width + parent.width, added = parent.width + parent.below - below;
        return {first, wider, parent.below, zeros + parent.zeros + width * added};
    }
    /// Number of entries of L, including the diagonal.
    Index entries() const { return width * (width + 1) / 2 + width * below; }

    bool isWorthwhile() const {
        const auto relaxation =
            std::find_if(std::begin(kRelaxations), std::end(kRelaxations),
                         [this](const Relaxation& r) { return width <= r.width; });
        return static_cast<double>(zeros) <= relaxation->zeros * static_cast<double>(entries());
    }
};

}  // namespace

SymbolicLdlt::SymbolicLdlt(const SparseMatrix& W, const SymbolicLdlt* similar)
    : starts(W.outerIndexPtr(), W.outerIndexPtr() + W.outerSize() + 1),
      rows(W.innerIndexPtr(), W.innerIndexPtr() + W.nonZeros()) {
    const Columns columns = findOrder(W, similar);
    findFronts(columns);
    findSubtrees();
    findRows();
    parallelFor(3, [this](Index task) {
        task == 0 ? findEntries() : task == 1 ? findPlaces() : findCopies();
    });
}

/// Calls work(begin, end) for the rows of each subtree, in parallel, and then for all other rows. A
/// row of L in a subtree has all of its entries in the subtree's columns.
template <class Work>
void SymbolicLdlt::forRows(const Work& work) const {
    parallelFor(static_cast<Index>(subtrees.size()),
                [&](Index t) { work(subtrees[t].firstColumn, subtrees[t].endColumn); });
    int next = 0;
    for (const Subtree& tree : subtrees) {
        work(next, tree.firstColumn);
        next = tree.endColumn;
    }
    work(next, static_cast<int>(inverse.size()));
}

SymbolicLdlt::Columns SymbolicLdlt::findOrder(const SparseMatrix& W, const SymbolicLdlt* similar) {
    const auto entriesOf = [](const Columns& columns) {
        return std::accumulate(columns.count.begin(), columns.count.end(), 0.0);
    };
    if (similar != nullptr && similar->order.size() == W.rows()) {
        adaptOrder(*similar);
        entriesWhenOrdered_ = similar->entriesWhenOrdered_;
        const Columns columns = eliminationTree();
        if (entriesOf(columns) <= kMaxFill * entriesWhenOrdered_) return postordered(columns);
    }
    Eigen::AMDOrdering<int>::PermutationType minimumDegree;  // its indices are those of `inverse`
    Eigen::AMDOrdering<int>()(W.selfadjointView<Eigen::Lower>(), minimumDegree);
    inverse.assign(minimumDegree.indices().begin(), minimumDegree.indices().end());
    order.resize(W.rows());
    for (int j = 0; j < W.rows(); ++j) order[inverse[j]] = j;
    const Columns columns = eliminationTree();
    entriesWhenOrdered_ = entriesOf(columns);
    return postordered(columns);
}

/// Adapts the order of a similar pattern. A new entry may join two subtrees of the old elimination
/// tree, and fill all fronts above both. One of its two rows is then moved up to the front where
/// the subtrees meet, as if into a separator: it only adds one row to each front on its way.
void SymbolicLdlt::adaptOrder(const SymbolicLdlt& similar) {
    const auto n = static_cast<int>(similar.inverse.size());
    const auto top = static_cast<int>(similar.fronts.size());  // a virtual front above all roots
    const auto parent = [&](int f) {
        return similar.parentFront_[f] < 0 ? top : similar.parentFront_[f];
    };
    // Subtrees are contiguous: front g is the root of fronts first[g] to g.
    std::vector<int> first(similar.fronts.size() + 1);
    std::iota(first.begin(), first.end(), 0);
    for (int f = 0; f < top; ++f) first[parent(f)] = std::min(first[parent(f)], first[f]);
    const auto isWithin = [&first](int f, int g) { return first[g] <= f && f <= g; };
    std::vector<int> frontOf(similar.inverse.size());  // front of each row of W
    std::vector<char> isMoved(similar.inverse.size(), 0);
    for (int i = 0; i < n; ++i) frontOf[i] = similar.frontOf_[similar.order[i]];
    for (int j = 0; j < n; ++j)
        for (int p = starts[j]; p < starts[j + 1]; ++p) {
            const int other = frontOf[rows[p]];
            if (rows[p] >= j || isWithin(other, frontOf[j]) || isWithin(frontOf[j], other))
                continue;
            while (!isWithin(other, frontOf[j])) frontOf[j] = parent(frontOf[j]);
            isMoved[j] = 1;
        }
    std::vector<int> next(similar.fronts.size() + 2, 0);
    for (const int f : frontOf) ++next[f + 1];
    std::partial_sum(next.begin(), next.end(), next.begin());
    order.resize(n);
    for (const bool moved : {true, false})
        for (const int i : similar.inverse)
            if ((isMoved[i] != 0) == moved) order[i] = next[frontOf[i]]++;
    inverse.resize(similar.inverse.size());
    for (int i = 0; i < n; ++i) inverse[order[i]] = i;
}

/// Sets `subtrees` to ranges that are closed even before the tree is known: no row of a range has
/// an entry of W, and hence of L, to the left of the range. In a postorder, which minimum degree
/// returns, most rows are in such ranges.
void SymbolicLdlt::findClosedRows() {
    const auto n = static_cast<int>(inverse.size());
    std::vector<int> first(inverse.size());  // first entry of each row
    parallelRows(n, [&](Index begin, Index end) {
        for (auto k = static_cast<int>(begin); k < end; ++k) {
            first[k] = k;
            for (int p = starts[inverse[k]]; p < starts[inverse[k] + 1]; ++p)
                first[k] = std::min(first[k], order[rows[p]]);
        }
    });
    subtrees.clear();
    for (int begin = 0, end; begin < n; begin = std::max(end, begin + 1)) {
        end = begin;
        while (end < n && end - begin < n / kClosedParts && first[end] >= begin) ++end;
        if ((end - begin) * kMaxParts >= n) subtrees.push_back({0, 0, begin, end, 0});
    }
}

/// The entries of row k of L are on the tree paths from the entries of row k of W up to k (Davis
/// 2006, section 4.1).
SymbolicLdlt::Columns SymbolicLdlt::eliminationTree() {
    findClosedRows();
    Columns columns{std::vector<int>(inverse.size(), -1), std::vector<int>(inverse.size(), 0)};
    std::vector<int> visited(inverse.size(), -1);
    forRows([&](int begin, int end) {
        for (int k = begin; k < end; ++k) {
            visited[k] = k;
            for (int p = starts[inverse[k]]; p < starts[inverse[k] + 1]; ++p) {
                if (order[rows[p]] > k) continue;
                for (int j = order[rows[p]]; visited[j] != k; j = columns.parent[j]) {
                    if (columns.parent[j] < 0) columns.parent[j] = k;
                    ++columns.count[j];
                    visited[j] = k;
                }
            }
        }
    });
    return columns;
}

SymbolicLdlt::Columns SymbolicLdlt::postordered(const Columns& columns) {
    const std::vector<int> number = postorder(columns.parent);
    Columns result{std::vector<int>(number.size(), -1), std::vector<int>(number.size())};
    for (int& j : order) j = number[j];
    for (std::size_t j = 0; j < number.size(); ++j) {
        if (columns.parent[j] >= 0) result.parent[number[j]] = number[columns.parent[j]];
        result.count[number[j]] = columns.count[j];
    }
    for (int i = 0; i < order.size(); ++i) inverse[order[i]] = i;
    return result;
}

void SymbolicLdlt::findFronts(const Columns& columns) {
    const auto& [parent, count] = columns;
    const auto n = static_cast<int>(parent.size());
    std::vector<Supernode> supernodes;
    for (int j = 0; j < n;) {
        Supernode supernode{j, 0, 0, 0};
        // A column's rows are the parent and some of the parent's rows: all if the counts match.
        do ++j, ++supernode.width;
        while (j < n && parent[j - 1] == j && count[j - 1] == count[j] + 1);
        supernode.below = count[j - 1];
        // Merge with the last child, then with the last child of both, and so on.
        while (!supernodes.empty()) {
            const Supernode& child = supernodes.back();
            const Supernode both = child.mergedWith(supernode);
            const int next = parent[supernode.first - 1];
            if (next < supernode.first || next >= j || !both.isWorthwhile()) break;
            supernode = both;
            supernodes.pop_back();
        }
        supernodes.push_back(supernode);
    }
    // In 64 bits even where Index has 32.
    const auto total =
        std::accumulate(supernodes.begin(), supernodes.end(), std::int64_t{0},
                        [](std::int64_t sum, const Supernode& s) { return sum + s.entries(); });
    if (total > std::numeric_limits<int>::max())
        throw SolverFailure(ErrorCode::TooManyVertices,
                            "the factor of W - sigma D (" + std::to_string(n) +
                                " rows) has too many entries: " + std::to_string(total));
    frontOf_.resize(parent.size());
    valueStarts.assign(parent.size() + 1, 0);
    rowStarts.resize(parent.size());
    joined.assign(parent.size(), 1);
    int rowCount = 0;
    for (const Supernode& supernode : supernodes) {
        Front front;
        front.first = static_cast<int>(supernode.first);
        front.width = static_cast<int>(supernode.width);
        front.below = static_cast<int>(supernode.below);
        front.firstRow = rowCount;
        rowCount += front.width + front.below;
        const int end = front.first + front.width;
        for (int j = front.first; j < end; ++j) {
            frontOf_[j] = static_cast<int>(fronts.size());
            rowStarts[j] = front.firstRow + j - front.first + 1;
            valueStarts[j + 1] = valueStarts[j] + rowCount - rowStarts[j];
        }
        joined[end - 1] = 0;
        fronts.push_back(front);
    }
    for (const Front& front : fronts) {
        const int next = parent[front.first + front.width - 1];
        parentFront_.push_back(next < 0 ? -1 : frontOf_[next]);
    }
    frontRows.resize(static_cast<std::size_t>(rowCount));
}

void SymbolicLdlt::findSubtrees() {
    subtrees.clear();
    const auto count = static_cast<int>(fronts.size());
    std::vector<Index> size(fronts.size(), 0);       // entries of L in each front's subtree
    std::vector<int> frontsBelow(fronts.size(), 1);  // number of fronts in it
    for (int f = 0; f < count; ++f) {
        size[f] += fronts[f].size();
        if (const int parent = parentFront_[f]; parent >= 0) {
            size[parent] += size[f];
            frontsBelow[parent] += frontsBelow[f];
        }
    }
    const Index total = valueStarts.back() + static_cast<Index>(inverse.size());
    const Index maxSize = total >= kMinShared ? total / kMinParts : 0;
    const auto isSmall = [&](int f) { return size[f] <= maxSize; };
    for (int f = 0; f < count; ++f) {
        const int parent = parentFront_[f];
        if (!isSmall(f) || size[f] <= (total - 1) / kMaxParts || (parent >= 0 && isSmall(parent)))
            continue;
        Subtree tree;
        tree.firstFront = f + 1 - frontsBelow[f];
        tree.endFront = f + 1;
        tree.firstColumn = fronts[tree.firstFront].first;
        tree.endColumn = fronts[f].first + fronts[f].width;
        subtrees.push_back(tree);
    }
    const auto sizeOf = [&](int t) { return size[subtrees[t].endFront - 1]; };
    largestFirst.resize(subtrees.size());
    std::iota(largestFirst.begin(), largestFirst.end(), 0);
    std::stable_sort(largestFirst.begin(), largestFirst.end(),
                     [&](int a, int b) { return sizeOf(a) > sizeOf(b); });
}

void SymbolicLdlt::findRows() {
    std::vector<int> ends;  // end of the rows known so far, by front
    for (const Front& front : fronts) {
        std::iota(&frontRows[front.firstRow], &frontRows[front.firstRow] + front.width,
                  front.first);
        ends.push_back(front.firstRow + front.width);
    }
    // The entries of a row of L are on the tree paths that start at the entries of W.
    std::vector<int> visited(fronts.size(), -1);
    forRows([&](int begin, int end) {
        for (int k = begin; k < end; ++k) {
            visited[frontOf_[k]] = k;
            for (int p = starts[inverse[k]]; p < starts[inverse[k] + 1]; ++p) {
                if (order[rows[p]] >= k) continue;
                for (int f = frontOf_[order[rows[p]]]; visited[f] != k; f = parentFront_[f]) {
                    frontRows[ends[f]++] = k;
                    visited[f] = k;
                }
            }
        }
    });
}

void SymbolicLdlt::setPositions(const Front& front, std::vector<int>& position) const {
    for (int i = 0; i < front.width + front.below; ++i) position[frontRows[front.firstRow + i]] = i;
}

void SymbolicLdlt::findPlaces() {
    std::vector<int> position(inverse.size());  // position of each row in the current front
    std::vector<int> pending;                   // fronts whose parents are yet to come
    for (int f = 0; f < static_cast<int>(fronts.size()); ++f) {
        Front& front = fronts[f];
        setPositions(front, position);
        for (; !pending.empty(); pending.pop_back(), ++front.children) {
            Front& child = fronts[pending.back()];
            const int* below = &frontRows[child.firstRow] + child.width;
            if (frontOf_[*below] != f) break;
            child.firstPlace = static_cast<int>(places.size());
            for (int i = 0; i < child.below; ++i) places.push_back(position[below[i]]);
        }
        if (front.below > 0) pending.push_back(f);
    }
}

void SymbolicLdlt::findEntries() {
    std::vector<int> position(inverse.size());  // position of each row in the current front
    entries.reserve((rows.size() + inverse.size()) / 2);
    for (Front& front : fronts) {
        setPositions(front, position);
        front.entriesBegin = static_cast<int>(entries.size());
        for (int j = front.first; j < front.first + front.width; ++j)
            for (int p = starts[inverse[j]]; p < starts[inverse[j] + 1]; ++p)
                if (const int row = order[rows[p]]; row >= j)
                    entries.push_back({p, position[row], j - front.first});
        front.entriesEnd = static_cast<int>(entries.size());
    }
}

void SymbolicLdlt::findCopies() {
    solveRows = frontRows;
    for (Subtree& tree : subtrees) {
        const Front& root = fronts[tree.endFront - 1];
        tree.firstCopy = static_cast<int>(copied.size());
        const auto below = frontRows.begin() + root.firstRow + root.width;
        copied.insert(copied.end(), below, below + root.below);
        // The rows of a subtree's fronts are its own columns or among the rows below its root.
        for (auto row = solveRows.begin() + fronts[tree.firstFront].firstRow;
             row != solveRows.begin() + root.firstRow + root.width + root.below; ++row)
            if (*row >= tree.endColumn)
                *row = static_cast<int>(inverse.size()) + tree.firstCopy +
                       static_cast<int>(std::lower_bound(below, below + root.below, *row) - below);
    }
}

bool SymbolicLdlt::hasPatternOf(const SparseMatrix& W) const {
    const int *start = W.outerIndexPtr(), *row = W.innerIndexPtr();
    return std::equal(starts.begin(), starts.end(), start, start + W.outerSize() + 1) &&
           std::equal(rows.begin(), rows.end(), row, row + W.nonZeros());
}

}  // namespace spectral
