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

}  // namespace

SymbolicLdlt::SymbolicLdlt(const SparseMatrix& W)
    : starts(W.outerIndexPtr(), W.outerIndexPtr() + W.outerSize() + 1),
      rows(W.innerIndexPtr(), W.innerIndexPtr() + W.nonZeros()) {
    const auto n = static_cast<std::size_t>(W.rows());
    Analysis analysis;
    analysis.analyzePattern(W);
    const auto& count = analysis.columnEntries();
    const Index entries = count.cast<Index>().sum();
    if (entries > std::numeric_limits<int>::max())
        throw InvalidMesh("the factorization of W - sigma D (" + std::to_string(n) +
                          " vertices) has too many entries, " + std::to_string(entries) +
                          ": apply 'Simplification: Quadric Edge Collapse Decimation' first");
    order = analysis.permutationP().indices();
    parent.assign(analysis.parent().begin(), analysis.parent().end());
    factorStarts.assign(n + 1, 0);
    std::partial_sum(count.begin(), count.end(), factorStarts.begin() + 1);
    // What is below the first row of a column fills that row's column: their numbers suffice.
    joined.assign(n, 0);
    for (int j = 0; j + 1 < W.rows(); ++j)
        joined[j] = parent[j] == j + 1 && count[j] == count[j + 1] + 1 ? 1 : 0;

    const auto forUpper = [&](const auto& visit) {
        for (int j = 0; j < W.cols(); ++j)
            for (int p = starts[j]; p < starts[j + 1]; ++p)
                if (order[rows[p]] <= order[j]) visit(order[rows[p]], order[j], p);
    };
    upperStarts.assign(n + 1, 0);
    forUpper([&](int, int column, int) { ++upperStarts[column + 1]; });
    std::partial_sum(upperStarts.begin(), upperStarts.end(), upperStarts.begin());
    upperRows.resize(static_cast<std::size_t>(upperStarts.back()));
    upperSources.resize(upperRows.size());
    std::vector<int> next(upperStarts.begin(), upperStarts.end() - 1);
    forUpper([&](int row, int column, int source) {
        const int place = next[column]++;
        upperRows[place] = row;
        upperSources[place] = source;
    });
}

bool SymbolicLdlt::isOf(const SparseMatrix& W) const {
    const int *start = W.outerIndexPtr(), *row = W.innerIndexPtr();
    return std::equal(starts.begin(), starts.end(), start, start + W.outerSize() + 1) &&
           std::equal(rows.begin(), rows.end(), row, row + W.nonZeros());
}

}  // namespace spectral
