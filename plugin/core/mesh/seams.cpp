#include "core/mesh/seams.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
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

/// The edges between sets of vertices, sorted, ends and all.
std::vector<Edge> rooted(std::vector<Edge> edges, UnionFind& vertices) {
    for (Edge& edge : edges) {
        const auto [low, high] = std::minmax({vertices.root(edge[0]), vertices.root(edge[1])});
        edge = {low, high};
    }
    std::sort(edges.begin(), edges.end());
    return edges;
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

/// Those of the sorted edges that there are once: they are still on the boundary.
std::vector<Edge> singleOf(const std::vector<Edge>& edges) {
    std::vector<Edge> single;
    for (std::size_t e = 0; e < edges.size(); ++e) {
        const bool isRepeated = (e > 0 && edges[e - 1] == edges[e]) ||
                                (e + 1 < edges.size() && edges[e + 1] == edges[e]);
        if (!isRepeated && edges[e][0] != edges[e][1]) single.push_back(edges[e]);
    }
    return single;
}

/// The shortest side of a triangle at each set of vertices; n, at the roots.
std::vector<double> shortestSides(const Vertices& X, const Faces& F, UnionFind& vertices) {
    std::vector<double> shortest(static_cast<std::size_t>(X.rows()),
                                 std::numeric_limits<double>::infinity());
    for (Index t = 0; t < F.rows(); ++t)
        for (int c = 0; c < 3; ++c) {
            const int i = F(t, c), j = F(t, (c + 1) % 3);
            const double length = (X.row(i) - X.row(j)).norm();
            for (const int root : {vertices.root(i), vertices.root(j)})
                shortest[root] = std::min(shortest[root], length);
        }
    return shortest;
}

/// The ends of boundary edges, and which are within round-off of each other.
class NearEnds {
  public:
    NearEnds(const Vertices& X, const std::vector<Edge>& edges, const std::vector<double>& shortest)
        : near_(static_cast<std::size_t>(X.rows())) {
        // Sweeps along a direction in which no mesh is flat; pairs are found from their lower end.
        const Eigen::Vector3d direction = Eigen::Vector3d(0.5377, 0.6231, 0.5680).normalized();
        const std::vector<int> ends = verticesOf(edges);
        std::vector<std::pair<double, int>> sorted;
        for (const int i : ends) sorted.emplace_back(X.row(i).dot(direction), i);
        std::sort(sorted.begin(), sorted.end());
        for (std::size_t a = 0; a < sorted.size(); ++a) {
            const auto [at, i] = sorted[a];
            near_[i].push_back(i);
            const double tolerance = kTiny * shortest[i];
            for (std::size_t b = a + 1; b < sorted.size() && sorted[b].first <= at + tolerance;
                 ++b) {
                const int j = sorted[b].second;
                if ((X.row(i) - X.row(j)).norm() > std::min(tolerance, kTiny * shortest[j]))
                    continue;
                near_[i].push_back(j);
                near_[j].push_back(i);
            }
        }
    }

    /// Those near an end, with itself.
    const std::vector<int>& of(int i) const { return near_[i]; }
    bool areNear(int i, int j) const {
        return std::find(near_[i].begin(), near_[i].end(), j) != near_[i].end();
    }

  private:
    // Corners off by 1e-5 of the size, as in a text of five digits: the bunny's 69,451 triangles,
    // with sides of 6e-3 to 7e-4 of the size, become one surface; at .005 they fall into 761 parts.
    // At .1, corners across the short sides of rocker-arm are near each other, too.
    static constexpr double kTiny = 0.02;

    std::vector<std::vector<int>> near_;
};

/// Unites the ends of those boundary edges that are within round-off of one other edge each.
void joinPairs(const Vertices& X, const Faces& F, const std::vector<Edge>& edges,
               UnionFind& vertices) {
    const NearEnds near(X, edges, shortestSides(X, F, vertices));
    std::vector<std::vector<int>> edgesAt(static_cast<std::size_t>(X.rows()));
    for (std::size_t e = 0; e < edges.size(); ++e)
        for (const int end : edges[e]) edgesAt[end].push_back(static_cast<int>(e));
    const auto otherEnd = [&](int e, int end) { return edges[e][edges[e][0] == end ? 1 : 0]; };
    struct Pair {
        int edge;
        int end;  // of `edge`, near the first end of the other
    };
    /// The only edge near one, or none.
    const auto partner = [&](int e) -> std::optional<Pair> {
        std::optional<Pair> found;
        for (const int end : near.of(edges[e][0]))
            for (const int other : edgesAt[end]) {
                if (other == e || !near.areNear(otherEnd(other, end), edges[e][1])) continue;
                if (found) return std::nullopt;
                found = Pair{other, end};
            }
        return found;
    };
    for (int e = 0; e < static_cast<int>(edges.size()); ++e) {
        const std::optional<Pair> pair = partner(e);
        if (!pair || pair->edge < e) continue;
        const std::optional<Pair> back = partner(pair->edge);
        if (!back || back->edge != e) continue;
        vertices.unite(edges[e][0], pair->end);
        vertices.unite(edges[e][1], otherEnd(pair->edge, pair->end));
    }
}

Vertices rounded(const Vertices& X) {
    constexpr double kRoundOff = 1e-6;
    return (X / (kRoundOff * boundingBoxDiagonal(X))).array().round();
}

}  // namespace

Seams findSeams(const Vertices& X, const Faces& F) {
    Seams seams;
    const std::vector<Edge> edges = boundaryEdges(F);
    if (edges.empty()) return seams;
    UnionFind vertices = joined(X, edges);
    const std::vector<Edge> boundary = singleOf(rooted(edges, vertices));
    if (!boundary.empty()) joinPairs(X, F, boundary, vertices);
    if (vertices.count() < X.rows()) seams.first = vertices.roots();
    seams.nearby = static_cast<int>(X.rows() - joined(rounded(X), rooted(edges, vertices)).count());
    return seams;
}

}  // namespace spectral
