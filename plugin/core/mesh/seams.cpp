#include "core/mesh/seams.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "core/mesh/measures.h"
#include "core/mesh/union_find.h"

namespace spectral {

namespace {

// Corners off by 1e-5 of the size, as in a text of five digits: 69,451 triangles with sides of 6e-3
// to 7e-4 of the size become one surface; at .005 they fall into 761 parts. At .1, corners across
// the short sides of a decimated part are near each other, too.
constexpr double kTiny = 0.02;

// A direction in which no mesh is flat: sweeps along it.
const Eigen::RowVector3d kSweep = Eigen::RowVector3d(0.5377, 0.6231, 0.5680).normalized();

using Edge = std::array<int, 2>;

Edge endsOf(const Side& side) { return {side.low, side.high}; }

/// The sides of triangles that no other has.
std::vector<Side> boundarySides(const SidesByEdge& edges) {
    std::vector<Side> sides;
    edges.forEachEdge([&](auto first, auto end) {
        if (end - first == 1) sides.push_back(*first);
    });
    return sides;
}

std::vector<int> verticesOf(const std::vector<Side>& sides) {
    std::vector<int> vertices;
    for (const Side& side : sides) vertices.insert(vertices.end(), {side.low, side.high});
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    return vertices;
}

/// For each end of a side, the first end at the same point; n.
std::vector<int> firstAtPoint(const Vertices& X, const std::vector<Side>& sides) {
    const auto point = [&](int i) { return std::array{X(i, 0), X(i, 1), X(i, 2)}; };
    std::vector<int> ends = verticesOf(sides);
    std::stable_sort(ends.begin(), ends.end(), [&](int i, int j) { return point(i) < point(j); });
    std::vector<int> first(static_cast<std::size_t>(X.rows()));
    for (std::size_t e = 0; e < ends.size(); ++e) {
        const bool isSame = e > 0 && point(ends[e - 1]) == point(ends[e]);
        first[ends[e]] = isSame ? first[ends[e - 1]] : ends[e];
    }
    return first;
}

/// The sides between sets of vertices, sorted, ends and all.
std::vector<Side> rooted(std::vector<Side> sides, UnionFind& vertices) {
    for (Side& side : sides)
        std::tie(side.low, side.high) =
            std::minmax({vertices.root(side.low), vertices.root(side.high)});
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
        return std::tie(a.low, a.high, a.number) < std::tie(b.low, b.high, b.number);
    });
    return sides;
}

/// Unites the ends of sides that have the same end points.
UnionFind joined(const Vertices& X, std::vector<Side> sides) {
    const std::vector<int> place = firstAtPoint(X, sides);
    const auto placed = [&](const Side& side) { return Edge{place[side.low], place[side.high]}; };
    for (Side& side : sides)
        if (place[side.low] > place[side.high]) std::swap(side.low, side.high);
    std::sort(sides.begin(), sides.end(),
              [&](const Side& a, const Side& b) { return placed(a) < placed(b); });
    UnionFind vertices(X.rows());
    for (std::size_t s = 1; s < sides.size(); ++s) {
        const Edge at = placed(sides[s]);
        if (at != placed(sides[s - 1]) || at[0] == at[1]) continue;
        vertices.unite(sides[s - 1].low, sides[s].low);
        vertices.unite(sides[s - 1].high, sides[s].high);
    }
    return vertices;
}

/// Those of the sorted sides whose edge there is once: they are still on the boundary.
std::vector<Side> singleOf(const std::vector<Side>& sides) {
    std::vector<Side> single;
    for (std::size_t s = 0; s < sides.size(); ++s) {
        const bool isRepeated = (s > 0 && endsOf(sides[s - 1]) == endsOf(sides[s])) ||
                                (s + 1 < sides.size() && endsOf(sides[s + 1]) == endsOf(sides[s]));
        if (!isRepeated && sides[s].low != sides[s].high) single.push_back(sides[s]);
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

/// The ends of sides, by their positions along a direction.
std::vector<std::pair<double, int>> sweep(const Vertices& X, const std::vector<Side>& sides) {
    std::vector<std::pair<double, int>> sorted;
    for (const int i : verticesOf(sides)) sorted.emplace_back(X.row(i).dot(kSweep), i);
    std::sort(sorted.begin(), sorted.end());
    return sorted;
}

/// The ends of boundary edges, and which are within round-off of each other.
class NearEnds {
  public:
    NearEnds(const Vertices& X, const std::vector<Side>& sides, const std::vector<double>& shortest)
        : near_(static_cast<std::size_t>(X.rows())) {
        // Pairs are found from their lower end.
        const std::vector<std::pair<double, int>> sorted = sweep(X, sides);
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
    std::vector<std::vector<int>> near_;
};

/// Unites the ends of those boundary edges that are within round-off of one other edge each.
void joinPairs(const Vertices& X, const std::vector<Side>& edges,
               const std::vector<double>& shortest, UnionFind& vertices) {
    const NearEnds near(X, edges, shortest);
    std::vector<std::vector<int>> edgesAt(static_cast<std::size_t>(X.rows()));
    for (std::size_t e = 0; e < edges.size(); ++e)
        for (const int end : endsOf(edges[e])) edgesAt[end].push_back(static_cast<int>(e));
    const auto otherEnd = [&](int e, int end) {
        return edges[e].low == end ? edges[e].high : edges[e].low;
    };
    struct Pair {
        int edge;
        int end;  // of `edge`, near the first end of the other
    };
    /// The only edge near one, or none.
    const auto partner = [&](int e) -> std::optional<Pair> {
        std::optional<Pair> found;
        for (const int end : near.of(edges[e].low))
            for (const int other : edgesAt[end]) {
                if (other == e || !near.areNear(otherEnd(other, end), edges[e].high)) continue;
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
        vertices.unite(edges[e].low, pair->end);
        vertices.unite(edges[e].high, otherEnd(pair->edge, pair->end));
    }
}

/// Finds the vertices that hang on boundary edges, and unites the ends of these edges with those of
/// the finer ones along them.
class HangingVertices {
  public:
    /// @param sides  of the boundary, between roots of `vertices`.
    HangingVertices(const Vertices& X, const Faces& F, const std::vector<Side>& sides,
                    const std::vector<double>& shortest, UnionFind& vertices)
        : X_(X), F_(F), shortest_(shortest), vertices_(vertices) {
        const std::vector<std::pair<double, int>> ends = sweep(X, sides);
        for (const Side& side : sides)
            for (const int end : endsOf(side)) sidesAt_[end].push_back(&side);
        for (const Side& side : sides) searchAlong(side, ends);
        std::sort(found_.begin(), found_.end(), [&](const Hanging& a, const Hanging& b) {
            const double first = lengthOf(a), second = lengthOf(b);
            return std::tie(second, a.side, a.share) < std::tie(first, b.side, b.share);
        });
        const auto isAtSame = [&](const Hanging& a, const Hanging& b) {
            return a.side == b.side &&
                   (at(a.vertex) - at(b.vertex)).norm() <=
                       kOnEdge * std::min(shortest_[a.vertex], shortest_[b.vertex]);
        };
        for (std::size_t k = 1; k < found_.size(); ++k)
            if (isAtSame(found_[k - 1], found_[k]))
                vertices.unite(found_[k - 1].vertex, found_[k].vertex);
        found_.erase(std::unique(found_.begin(), found_.end(), isAtSame), found_.end());
        for (Hanging& one : found_) {
            for (int* end : {&one.vertex, &one.from, &one.to}) *end = vertices.root(*end);
            // The longest edge decides, and edges may not bend one another.
            one.follows = edgeOf_.count(one.vertex) == 0 && !dependsOn(one.from, one.vertex) &&
                          !dependsOn(one.to, one.vertex);
            if (one.follows) edgeOf_[one.vertex] = {one.from, one.to};
        }
    }

    std::vector<Hanging> found() { return std::move(found_); }

  private:
    Eigen::RowVector3d at(int i) const { return X_.row(i); }
    double lengthOf(const Hanging& one) const { return (at(one.to) - at(one.from)).norm(); }

    void searchAlong(const Side& side, const std::vector<std::pair<double, int>>& ends) {
        const auto [low, high] = std::minmax({at(side.low).dot(kSweep), at(side.high).dot(kSweep)});
        for (auto e = std::lower_bound(ends.begin(), ends.end(), std::pair(low, 0));
             e != ends.end() && e->first <= high; ++e) {
            const int i = e->second;
            const double share = i == side.low || i == side.high ? 0.0 : shareOf(side, i);
            if (share <= 0.0 || share >= 1.0 || !goesAlong(side, i)) continue;
            const double rounded = std::round(kDyadic * share) / kDyadic;
            found_.push_back({i, side.low, side.high,
                              std::abs(rounded - share) < kRoundOff ? rounded : share, side.number,
                              false});
        }
    }

    /// The share of its length at which a vertex is on a side; 0 or 1 within round-off of the ends,
    /// -1 if it is elsewhere.
    double shareOf(const Side& side, int i) const {
        const Eigen::RowVector3d along = at(side.high) - at(side.low), to = at(i) - at(side.low);
        const double length = along.norm(), distance = to.dot(along) / length;
        const double tiny = kOnEdge * shortest_[i];
        if (!(length > 0.0)) return -1.0;
        if ((to - distance / length * along).norm() > tiny) return -1.0;
        if (distance < -tiny || distance > length + tiny) return -1.0;
        return distance <= tiny ? 0.0 : distance >= length - tiny ? 1.0 : distance / length;
    }

    /// Whether a side at a vertex goes along another side; unites their ends.
    bool goesAlong(const Side& side, int i) {
        bool isAlong = false;
        for (const Side* finer : sidesAt_[i]) {
            if (finer->face() == side.face() || areLayers(side, *finer)) continue;
            const int other = finer->low == i ? finer->high : finer->low;
            const double share = shareOf(side, other);
            if (share < 0.0) continue;
            isAlong = true;
            if (share == 0.0 || share == 1.0)
                vertices_.unite(other, share == 0.0 ? side.low : side.high);
        }
        return isAlong;
    }

    /// Whether the triangles of two sides along each other lie over one another: both run the same
    /// way, on the same side. Levels of detail of one surface do not meet at its boundary.
    bool areLayers(const Side& a, const Side& b) const {
        const auto start = [&](const Side& s) { return at(F_(s.face(), s.corner())); };
        const auto way = [&](const Side& s) -> Eigen::RowVector3d {
            return at(F_(s.face(), (s.corner() + 1) % 3)) - start(s);
        };
        const Eigen::RowVector3d along = way(a).normalized();
        const auto across = [&](const Side& s) -> Eigen::RowVector3d {
            const Eigen::RowVector3d to = at(F_(s.face(), s.opposite())) - start(s);
            return to - to.dot(along) * along;
        };
        return along.dot(way(b)) > 0.0 && across(a).dot(across(b)) > 0.0;
    }

    bool dependsOn(int i, int other) const {
        const auto found = edgeOf_.find(i);
        return i == other || (found != edgeOf_.end() && (dependsOn(found->second[0], other) ||
                                                         dependsOn(found->second[1], other)));
    }

    // Of the shortest side: single precision leaves 6e-6 of coordinates 100 sides from the origin.
    // Terrains in degrees and metres have lines of vertices 3e-4 of a side apart.
    static constexpr double kOnEdge = 1e-5;
    static constexpr double kDyadic = 1024.0;  // as shares are in octrees, but for round-off
    static constexpr double kRoundOff = 1e-6;

    const Vertices& X_;
    const Faces& F_;
    const std::vector<double>& shortest_;
    UnionFind& vertices_;
    std::map<int, std::vector<const Side*>> sidesAt_;
    std::map<int, Edge> edgeOf_;  // on which a vertex is kept
    std::vector<Hanging> found_;
};

Vertices rounded(const Vertices& X) {
    constexpr double kRoundOff = 1e-6;
    return (X / (kRoundOff * boundingBoxDiagonal(X))).array().round();
}

}  // namespace

Seams findSeams(const Vertices& X, const Faces& F, const SidesByEdge& edges) {
    Seams seams;
    const std::vector<Side> sides = boundarySides(edges);
    if (sides.empty()) return seams;
    UnionFind vertices = joined(X, sides);
    std::vector<Side> boundary = singleOf(rooted(sides, vertices));
    if (!boundary.empty()) {
        const std::vector<double> shortest = shortestSides(X, F, vertices);
        joinPairs(X, boundary, shortest, vertices);
        boundary = singleOf(rooted(std::move(boundary), vertices));
        seams.hanging = HangingVertices(X, F, boundary, shortest, vertices).found();
    }
    if (vertices.count() < X.rows()) seams.first = vertices.roots();
    seams.nearby = static_cast<int>(X.rows() - joined(rounded(X), rooted(sides, vertices)).count());
    return seams;
}

}  // namespace spectral
