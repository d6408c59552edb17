#include "core/analysis/evaluated_part.h"

#include <functional>
#include <queue>
#include <tuple>

#include "core/laplacian/interior.h"
#include "core/mesh/creases.h"

namespace spectral {

namespace {

std::vector<bool> endsOf(const Surface& surface, double creaseAngle) {
    std::vector<bool> ends = boundaryVertices(surface.F, surface.X.rows());
    if (creaseAngle >= 180.0) return ends;
    const std::vector<bool> creases = creaseVertices(surface.X, surface.F, creaseAngle);
    for (std::size_t i = 0; i < ends.size(); ++i) ends[i] = ends[i] || creases[i];
    return ends;
}

}  // namespace

/// Dijkstra's algorithm, except that each vertex knows its nearest end and measures straight to it:
/// paths along edges would depend on how the surface is meshed.
std::vector<bool> farFromEnds(const Surface& surface, const SparseMatrix& W, double creaseAngle,
                              double distance) {
    std::vector<bool> isFar(static_cast<std::size_t>(surface.X.rows()), true);
    if (distance <= 0.0) return isFar;
    using Visit = std::tuple<double, Index, Index>;  // distance, vertex, end
    std::priority_queue<Visit, std::vector<Visit>, std::greater<>> next;
    const std::vector<bool> ends = endsOf(surface, creaseAngle);
    for (Index i = 0; i < surface.X.rows(); ++i)
        if (ends[i]) next.emplace(0.0, i, i);
    while (!next.empty()) {
        const auto [along, i, end] = next.top();
        next.pop();
        if (!isFar[i]) continue;
        isFar[i] = false;
        for (SparseMatrix::InnerIterator entry(W, i); entry; ++entry) {
            const Index j = entry.index();
            const double straight = (surface.X.row(j) - surface.X.row(end)).norm();
            if (isFar[j] && straight <= distance) next.emplace(straight, j, end);
        }
    }
    return isFar;
}

}  // namespace spectral
