#include "core/analysis/evaluated_part.h"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
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
    const std::size_t n = static_cast<std::size_t>(surface.X.rows());
    std::vector<bool> isFar(n, true);
    if (distance <= 0.0) return isFar;
    const std::vector<Edge> ends = endsOf(surface, creaseAngle);
    std::vector<double> nearest(n, std::numeric_limits<double>::infinity());
    for (const Edge& end : ends)
        for (const Index i : end) nearest[i] = 0.0;
    using Visit = std::tuple<double, Index, std::size_t>;  // distance, vertex, end
    std::priority_queue<Visit, std::vector<Visit>, std::greater<>> next;
    const auto reachNeighbours = [&](Index i, std::size_t end) {
        for (SparseMatrix::InnerIterator entry(W, i); entry; ++entry) {
            const Index j = entry.index();
            if (nearest[j] == 0.0) continue;
            const double straight = distanceToEdge(surface.X, j, ends[end]);
            if (straight > distance || straight >= nearest[j]) continue;
            nearest[j] = straight;
            next.emplace(straight, j, end);
        }
    };
    for (std::size_t end = 0; end < ends.size(); ++end)
        for (const Index i : ends[end]) reachNeighbours(i, end);
    while (!next.empty()) {
        const auto [straight, i, end] = next.top();
        next.pop();
        if (straight == nearest[i]) reachNeighbours(i, end);
    }
    for (std::size_t i = 0; i < n; ++i) isFar[i] = nearest[i] > distance;
    return isFar;
}

}  // namespace spectral
