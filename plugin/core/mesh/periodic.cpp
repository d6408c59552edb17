#include "core/mesh/periodic.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "core/mesh/measures.h"
#include "core/mesh/sides.h"
#include "core/mesh/surface.h"

namespace spectral {

namespace {

/// An edge of the boundary, and the third corner of its triangle.
struct Rim {
    Index i, j, inner;
};

using Pair = std::array<Index, 2>;

constexpr double kRoundOff = 1e-6;  // of the diagonal
constexpr std::size_t kFewest = 3;  // vertices of a side: fewer match by chance

/// Whether the surface stays within the sides, as a duct's walls do, in place of crossing them: at
/// most edges between vertices of a side, the inner corner is no further in.
bool isWall(const Vertices& V, const std::vector<Rim>& rims, const std::vector<Pair>& pairs,
            int axis) {
    std::vector<int> side(static_cast<std::size_t>(V.rows()), 0);
    for (const auto& [low, high] : pairs) {
        side[low] = 1;
        side[high] = -1;
    }
    const double round = kRoundOff * boundingBoxDiagonal(V);
    int crossing = 0, all = 0;
    for (const Rim& rim : rims) {
        if (side[rim.i] == 0 || side[rim.i] != side[rim.j]) continue;
        const double middle = 0.5 * (V(rim.i, axis) + V(rim.j, axis));
        crossing += side[rim.i] * (V(rim.inner, axis) - middle) > round;
        ++all;
    }
    return 2 * crossing <= all;
}

/// Vertices around which corners that follow and corners that precede them are not the same: all of
/// the boundary, and those where triangles are not consistently oriented.
std::vector<bool> openVertices(Index n, const Faces& F) {
    const auto mixed = [](int i) {  // sums of it are equal if vertices are
        const std::uint64_t product = (static_cast<std::uint64_t>(i) + 1) * 0x9e3779b97f4a7c15U;
        return (product ^ (product >> 29)) * 0xbf58476d1ce4e5b9U;
    };
    std::vector<std::uint64_t> sums(static_cast<std::size_t>(n), 0);
    for (Index t = 0; t < F.rows(); ++t) {
        const std::array<std::uint64_t, 3> of = {mixed(F(t, 0)), mixed(F(t, 1)), mixed(F(t, 2))};
        for (int c = 0; c < 3; ++c) sums[F(t, c)] += of[(c + 1) % 3] - of[(c + 2) % 3];
    }
    std::vector<bool> isOpen(sums.size());
    for (std::size_t i = 0; i < sums.size(); ++i) isOpen[i] = sums[i] != 0;
    return isOpen;
}

/// The triangles with a side between two of these vertices.
Faces trianglesAlong(const Faces& F, const std::vector<bool>& isOpen) {
    std::vector<Index> along;
    for (Index t = 0; t < F.rows(); ++t)
        if (isOpen[F(t, 0)] + isOpen[F(t, 1)] + isOpen[F(t, 2)] > 1) along.push_back(t);
    return F(along, Eigen::all);
}

/// @param isOpen  of the whole mesh: other edges have a side in triangles that are not here.
std::vector<Rim> rimsOf(const Surface& surface, const std::vector<bool>& isOpen) {
    const Faces& F = surface.F;
    std::vector<Rim> rims;
    SidesByEdge(F).forEachEdge([&](auto first, auto end) {
        if (end - first != 1) return;
        if (!isOpen[surface.vertex[first->low]] || !isOpen[surface.vertex[first->high]]) return;
        const int t = first->face(), c = first->corner();
        rims.push_back({F(t, c), F(t, (c + 1) % 3), F(t, (c + 2) % 3)});
    });
    return rims;
}

/// Pairs on sides that are not flat, as of a cell that was cut and then moved: every vertex of the
/// boundary has a partner, along two axes or three.
std::vector<Pair> pairsOfCells(const Vertices& V, const std::vector<Rim>& rims) {
    std::vector<Index> boundary;
    for (const Rim& rim : rims) boundary.push_back(rim.i);
    std::sort(boundary.begin(), boundary.end());
    boundary.erase(std::unique(boundary.begin(), boundary.end()), boundary.end());
    const double round = kRoundOff * boundingBoxDiagonal(V);
    std::vector<Pair> pairs;
    std::vector<bool> isPaired(static_cast<std::size_t>(V.rows()), false);
    int cells = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        constexpr double kSlant = 0.7548776662466927;  // of no grid: places of one key are one
        const auto key = [&](Index i) { return V(i, u) + kSlant * V(i, v); };
        std::sort(boundary.begin(), boundary.end(), [&](Index i, Index j) {
            return std::make_pair(key(i), i) < std::make_pair(key(j), j);
        });
        std::vector<Pair> found;
        double period = 0.0;
        for (std::size_t k = 0; k < boundary.size(); ++k)
            for (std::size_t l = k + 1; l < boundary.size(); ++l) {
                Index i = boundary[k], j = boundary[l];
                if (key(j) - key(i) > 2.0 * round) break;
                if (std::abs(V(j, u) - V(i, u)) > round || std::abs(V(j, v) - V(i, v)) > round)
                    continue;
                if (V(i, axis) > V(j, axis)) std::swap(i, j);
                found.push_back({i, j});
                period = std::max(period, V(j, axis) - V(i, axis));
            }
        found.erase(std::remove_if(found.begin(), found.end(),
                                   [&](const Pair& pair) {
                                       return V(pair[1], axis) - V(pair[0], axis) < period - round;
                                   }),
                    found.end());
        if (found.size() < kFewest || period <= round || isWall(V, rims, found, axis)) continue;
        ++cells;
        for (const auto& [i, j] : found) isPaired[i] = isPaired[j] = true;
        pairs.insert(pairs.end(), found.begin(), found.end());
    }
    const bool areAll =
        std::all_of(boundary.begin(), boundary.end(), [&](Index i) { return isPaired[i]; });
    return cells > 1 && areAll ? pairs : std::vector<Pair>();
}

/// The same for a mesh whose seams are joined.
/// @param low, high  corners of the box of the whole mesh.
std::vector<Pair> pairsOfJoined(const Vertices& V, const std::vector<Rim>& rims,
                                const Eigen::RowVector3d& low, const Eigen::RowVector3d& high) {
    const double round = kRoundOff * (high - low).norm();
    if (rims.empty() || (high - low).minCoeff() <= round) return {};  // a flat rectangle is no cell
    std::vector<bool> isBoundary(static_cast<std::size_t>(V.rows()), false);
    for (const Rim& rim : rims) isBoundary[rim.i] = isBoundary[rim.j] = true;
    std::vector<Pair> pairs;
    int cells = 0;        // axes along which there are pairs
    bool isTube = false;  // along the last of them
    for (int axis = 0; axis < 3; ++axis) {
        using Placed = std::pair<std::array<double, 2>, Index>;
        const auto side = [&](double at) {
            std::vector<Placed> found;
            for (Index i = 0; i < V.rows(); ++i)
                if (isBoundary[i] && std::abs(V(i, axis) - at) <= round)
                    found.push_back({{V(i, (axis + 1) % 3), V(i, (axis + 2) % 3)}, i});
            std::sort(found.begin(), found.end());
            return found;
        };
        /// The vertex of the other side that is at the same place, or -1.
        const auto partner = [&](const Placed& one, const std::vector<Placed>& others) -> Index {
            auto at = std::lower_bound(others.begin(), others.end(),
                                       Placed{{one.first[0] - round, one.first[1]}, 0});
            for (; at != others.end() && at->first[0] <= one.first[0] + round; ++at)
                if (std::abs(at->first[1] - one.first[1]) <= round) return at->second;
            return -1;
        };
        const std::vector<Placed> a = side(low[axis]), b = side(high[axis]);
        if (a.size() < kFewest || a.size() != b.size()) continue;
        const std::size_t before = pairs.size();
        for (const Placed& one : a)
            if (const Index other = partner(one, b); other >= 0)
                pairs.push_back({one.second, other});
        const auto isIn = [&](const Rim& rim, double at) {
            return std::abs(V(rim.i, axis) - at) <= round && std::abs(V(rim.j, axis) - at) <= round;
        };
        const std::vector<Pair> found(pairs.begin() + static_cast<std::ptrdiff_t>(before),
                                      pairs.end());
        if (found.size() < a.size() || isWall(V, rims, found, axis)) {
            pairs.resize(before);
            continue;
        }
        ++cells;
        isTube = std::all_of(rims.begin(), rims.end(), [&](const Rim& rim) {
            return isIn(rim, low[axis]) || isIn(rim, high[axis]);
        });
    }
    if (cells == 1 && isTube) pairs.clear();
    return pairs.empty() ? pairsOfCells(V, rims) : pairs;
}

}  // namespace

std::vector<std::array<Index, 2>> periodicPairs(const Vertices& V, const Faces& F) {
    const std::vector<bool> isOpen = openVertices(V.rows(), F);
    const Faces along = trianglesAlong(F, isOpen);
    if (along.rows() == 0) return {};
    // The sides of a box whose faces have corners of their own are no boundary.
    const Surface surface = joinedSurface(V, along);
    Eigen::RowVector3d low = V.row(F(0, 0)), high = low;
    for (const int i : F.reshaped()) {
        low = low.cwiseMin(V.row(i));
        high = high.cwiseMax(V.row(i));
    }
    const Eigen::RowVector3d moved = surface.X.row(0) - V.row(surface.vertex[0]);
    std::vector<Pair> pairs =
        pairsOfJoined(surface.X, rimsOf(surface, isOpen), low + moved, high + moved);
    for (Pair& pair : pairs)
        for (Index& i : pair) i = surface.vertex[i];
    return pairs;
}

double largestMismatch(const std::vector<std::array<Index, 2>>& pairs, const Vertices& before,
                       const Vertices& after) {
    double largest = 0.0;
    for (const auto& [i, j] : pairs)
        largest = std::max(
            largest, ((after.row(j) - before.row(j)) - (after.row(i) - before.row(i))).norm());
    return largest;
}

}  // namespace spectral
