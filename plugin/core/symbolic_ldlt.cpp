#include "symbolic_ldlt.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <limits>
#include <numeric>
#include <string>

#include "errors.h"

namespace spectral {

namespace {

/// What Eigen's analysis of a pattern keeps to itself.
struct Analysis : Eigen::SimplicialLDLT<SparseMatrix, Eigen::Lower, Eigen::AMDOrdering<int>> {
    const auto& parent() const { return m_parent; }
    const auto& columnEntries() const { return m_nonZerosPerCol; }
};

/// Numbers the nodes of a forest so that children come before their parents and every subtree is in
/// one piece.
/// @param parent  of each node, with a larger number; -1 of roots.
std::vector<int> postorder(const std::vector<int>& parent) {
    const auto n = static_cast<int>(parent.size());
    std::vector<int> size(parent.size(), 1);  // of the subtrees
    for (int i = 0; i < n; ++i)
        if (parent[i] >= 0) size[parent[i]] += size[i];
    // Subtrees take their places from the end of their parent's on; a node is the last of its own.
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

}  // namespace

SymbolicLdlt::SymbolicLdlt(const SparseMatrix& W)
    : starts(W.outerIndexPtr(), W.outerIndexPtr() + W.outerSize() + 1),
      rows(W.innerIndexPtr(), W.innerIndexPtr() + W.nonZeros()) {
    const std::vector<int> parent = findOrder(W);
    findRows(parent);
    findFronts();
}

std::vector<int> SymbolicLdlt::findOrder(const SparseMatrix& W) {
    const auto n = static_cast<std::size_t>(W.rows());
    Analysis analysis;
    analysis.analyzePattern(W);
    const auto& count = analysis.columnEntries();
    const Index total = count.cast<Index>().sum();
    if (total > std::numeric_limits<int>::max())
        throw InvalidMesh("the factorization of W - sigma D (" + std::to_string(n) +
                          " vertices) has too many entries, " + std::to_string(total) +
                          ": apply 'Simplification: Quadric Edge Collapse Decimation' first");
    const std::vector<int> tree(analysis.parent().begin(), analysis.parent().end());
    const std::vector<int> number = postorder(tree);
    order.resize(W.rows());
    for (Index i = 0; i < W.rows(); ++i) order[i] = number[analysis.permutationP().indices()[i]];
    inverse_.resize(n);
    for (int i = 0; i < W.rows(); ++i) inverse_[order[i]] = i;
    std::vector<int> parent(n, -1);
    factorStarts.assign(n + 1, 0);
    for (std::size_t i = 0; i < n; ++i) {
        if (tree[i] >= 0) parent[number[i]] = number[tree[i]];
        factorStarts[number[i] + 1] = count[i];
    }
    std::partial_sum(factorStarts.begin(), factorStarts.end(), factorStarts.begin());
    return parent;
}

void SymbolicLdlt::findRows(const std::vector<int>& parent) {
    const auto n = static_cast<int>(parent.size());
    factorRows.resize(static_cast<std::size_t>(factorStarts.back()));
    std::vector<int> ends(factorStarts.begin(), factorStarts.end() - 1);
    std::vector<int> visited(parent.size(), -1);
    // Row k of L has its entries where paths in the elimination tree lead from those of W.
    for (int k = 0; k < n; ++k) {
        visited[k] = k;
        for (int p = starts[inverse_[k]]; p < starts[inverse_[k] + 1]; ++p)
            for (int j = order[rows[p]]; j < k && visited[j] != k; j = parent[j]) {
                factorRows[ends[j]++] = k;
                visited[j] = k;
            }
    }
    // What is below the first row of a column fills that row's column: their numbers suffice.
    joined.assign(parent.size(), 0);
    const auto count = [&](int j) { return factorStarts[j + 1] - factorStarts[j]; };
    for (int j = 0; j + 1 < n; ++j)
        joined[j] = parent[j] == j + 1 && count(j) == count(j + 1) + 1 ? 1 : 0;
}

void SymbolicLdlt::findFronts() {
    const auto n = static_cast<int>(joined.size());
    std::vector<int> frontOf(joined.size());
    for (int j = 0; j < n; ++j) {
        if (j == 0 || !joined[j - 1]) {
            fronts.emplace_back();
            fronts.back().first = j;
        }
        frontOf[j] = static_cast<int>(fronts.size()) - 1;
        ++fronts.back().width;
    }
    std::vector<int> position(joined.size());  // of a row in the front
    std::vector<int> waiting;                  // fronts whose parents are still to come
    entries.reserve((rows.size() + joined.size()) / 2);
    for (int f = 0; f < static_cast<int>(fronts.size()); ++f) {
        Front& front = fronts[f];
        const int end = front.first + front.width;
        const int* below = factorRows.data() + factorStarts[end - 1];
        front.below = factorStarts[end] - factorStarts[end - 1];
        for (int j = front.first; j < end; ++j) position[j] = j - front.first;
        for (int i = 0; i < front.below; ++i) position[below[i]] = front.width + i;

        front.entriesBegin = static_cast<int>(entries.size());
        for (int j = front.first; j < end; ++j)
            for (int p = starts[inverse_[j]]; p < starts[inverse_[j] + 1]; ++p)
                if (const int row = order[rows[p]]; row >= j)
                    entries.push_back({p, position[row], j - front.first});
        front.entriesEnd = static_cast<int>(entries.size());

        for (; !waiting.empty(); waiting.pop_back(), ++front.children) {
            Front& child = fronts[waiting.back()];
            const int last = child.first + child.width - 1;
            if (frontOf[factorRows[factorStarts[last]]] != f) break;
            child.firstPlace = static_cast<int>(places.size());
            for (int p = factorStarts[last]; p < factorStarts[last + 1]; ++p)
                places.push_back(position[factorRows[p]]);
        }
        if (front.below > 0) waiting.push_back(f);
    }
}

bool SymbolicLdlt::isOf(const SparseMatrix& W) const {
    const int *start = W.outerIndexPtr(), *row = W.innerIndexPtr();
    return std::equal(starts.begin(), starts.end(), start, start + W.outerSize() + 1) &&
           std::equal(rows.begin(), rows.end(), row, row + W.nonZeros());
}

}  // namespace spectral
