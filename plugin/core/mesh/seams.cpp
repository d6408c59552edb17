#include "core/mesh/seams.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/mesh/measures.h"
#include "core/mesh/sides.h"
#include "core/mesh/union_find.h"

namespace spectral {

namespace {

using Edge = std::array<int, 2>;

std::vector<Edge> boundaryEdges(const Faces& F) {
    std::vector<Edge> edges;
    SidesByEdge(F).forEachEdge([&](auto first, auto end) {
        if (end - first == 1) edges.push_back({first->low, first->high});
    });
    return edges;
}

std::vector<int> verticesOf(const std::vector<Edge>& edges) {
    std::vector<int> vertices;
    for (const Edge& edge : edges) vertices.insert(vertices.end(), edge.begin(), edge.end());
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    return vertices;
}

/// For each end of an edge, the first end at the same point; n.
std::vector<int> firstAtPoint(const Vertices& X, const std::vector<Edge>& edges) {
    const auto point = [&](int i) { return std::array{X(i, 0), X(i, 1), X(i, 2)}; };
    std::vector<int> ends = verticesOf(edges);
    std::stable_sort(ends.begin(), ends.end(), [&](int i, int j) { return point(i) < point(j); });
    std::vector<int> first(static_cast<std::size_t>(X.rows()));
    for (std::size_t e = 0; e < ends.size(); ++e) {
        const bool isSame = e > 0 && point(ends[e - 1]) == point(ends[e]);
        first[ends[e]] = isSame ? first[ends[e - 1]] : ends[e];
    }
    return first;
}

/// Unites the ends of edges that have the same end points.
UnionFind joined(const Vertices& X, std::vector<Edge> edges) {
    const std::vector<int> place = firstAtPoint(X, edges);
    const auto placed = [&](const Edge& edge) { return Edge{place[edge[0]], place[edge[1]]}; };
    for (Edge& edge : edges)
        if (place[edge[0]] > place[edge[1]]) std::swap(edge[0], edge[1]);
    std::sort(edges.begin(), edges.end(),
              [&](const Edge& a, const Edge& b) { return placed(a) < placed(b); });
    UnionFind vertices(X.rows());
    for (std::size_t e = 1; e < edges.size(); ++e) {
        const Edge at = placed(edges[e]);
        if (at != placed(edges[e - 1]) || at[0] == at[1]) continue;
        vertices.unite(edges[e - 1][0], edges[e][0]);
        vertices.unite(edges[e - 1][1], edges[e][1]);
    }
    return vertices;
}

Vertices rounded(const Vertices& X) {
    constexpr double kRoundOff = 1e-6;
    return (X / (kRoundOff * boundingBoxDiagonal(X))).array().round();
}

}  // namespace

Seams findSeams(const Vertices& X, const Faces& F) {
    Seams seams;
    std::vector<Edge> edges = boundaryEdges(F);
    if (edges.empty()) return seams;
    UnionFind vertices = joined(X, edges);
    if (vertices.count() < X.rows()) seams.first = vertices.roots();
    for (Edge& edge : edges) edge = {vertices.root(edge[0]), vertices.root(edge[1])};
    seams.nearby = static_cast<int>(X.rows() - joined(rounded(X), std::move(edges)).count());
    return seams;
}

}  // namespace spectral
