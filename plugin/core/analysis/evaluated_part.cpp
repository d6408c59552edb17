#include "core/analysis/evaluated_part.h"

#include <algorithm>
#include <array>
#include <functional>
#include <queue>
#include <tuple>

#include "core/mesh/creases.h"
#include "core/mesh/sides.h"

namespace spectral {

namespace {

using Edge = std::array<Index, 2>;

std::vector<Edge> endsOf(const Surface& surface, double creaseAngle) {
    std::vector<Edge> ends;
    if (creaseAngle < 180.0) ends = creaseEdges(surface.X, surface.F, creaseAngle);
    SidesByEdge(surface.F).forEachEdge([&](auto first, auto end) {
        if (end - first == 1) ends.push_back({first->low, first->high});
    });
    return ends;
}

double distanceToEdge(const Vertices& X, Index i, const Edge& edge) {
    const Eigen::RowVector3d a = X.row(edge[0]), d = X.row(edge[1]) - a, p = X.row(i) - a;
    const double squared = d.squaredNorm();
    const double at = squared > 0.0 ? std::clamp(p.dot(d) / squared, 0.0, 1.0) : 0.0;
    return (p - at * d).norm();
}

}  // namespace

/// Dijkstra's algorithm, except that each vertex knows its nearest end, an edge, and measures
/// straight to it: paths along edges would depend on how the surface is meshed.
std::vector<bool> farFromEnds(const Surface& surface, const SparseMatrix& W, double creaseAngle,
                              double distance) {
    std::vector<bool> isFar(static_cast<std::size_t>(surface.X.rows()), true);
    if (distance <= 0.0) return isFar;
    using Visit = std::tuple<double, Index, std::size_t>;  // distance, vertex, end
    std::priority_queue<Visit, std::vector<Visit>, std::greater<>> next;
    const std::vector<Edge> ends = endsOf(surface, creaseAngle);
    for (std::size_t k = 0; k < ends.size(); ++k)
        for (const Index i : ends[k]) next.emplace(0.0, i, k);
    while (!next.empty()) {
        const auto [along, i, end] = next.top();
        next.pop();
        if (!isFar[i] && along > 0.0) continue;  // from an end of several edges, all are tried
        isFar[i] = false;
        for (SparseMatrix::InnerIterator entry(W, i); entry; ++entry) {
            const Index j = entry.index();
            if (!isFar[j]) continue;
            const double straight = distanceToEdge(surface.X, j, ends[end]);
            if (straight <= distance) next.emplace(straight, j, end);
        }
    }
    return isFar;
}

}  // namespace spectral
