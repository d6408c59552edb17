#include "core/mesh/periodic.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/mesh/measures.h"
#include "core/mesh/sides.h"

namespace spectral {

namespace {

/// An edge of the boundary, and the third corner of its triangle.
struct Rim {
    Index i, j, inner;
};

std::vector<Rim> rimsOf(const Faces& F) {
    std::vector<Rim> rims;
    SidesByEdge(F).forEachEdge([&](auto first, auto end) {
        if (end - first != 1) return;
        const int t = first->face(), c = first->corner();
        rims.push_back({F(t, c), F(t, (c + 1) % 3), F(t, (c + 2) % 3)});
    });
    return rims;
}

}  // namespace

std::vector<std::array<Index, 2>> periodicPairs(const Vertices& V, const Faces& F) {
    constexpr double kRoundOff = 1e-6;  // of the diagonal
    constexpr std::size_t kFewest = 3;  // vertices of a side: fewer match by chance
    std::vector<std::array<Index, 2>> pairs;
    if (V.rows() == 0) return pairs;
    const Eigen::RowVector3d low = V.colwise().minCoeff(), high = V.colwise().maxCoeff();
    const double round = kRoundOff * boundingBoxDiagonal(V);
    if ((high - low).minCoeff() <= round) return pairs;  // a flat rectangle is no cell
    std::vector<bool> isBoundary;
    std::vector<Rim> rims;
    int cells = 0;        // axes along which there are pairs
    bool isTube = false;  // along the last of them
    for (int axis = 0; axis < 3; ++axis) {
        using Placed = std::pair<std::array<double, 2>, Index>;
        const auto side = [&](double at) {
            std::vector<Placed> found;
            for (Index i = 0; i < V.rows(); ++i)
                if (std::abs(V(i, axis) - at) <= round &&
                    (isBoundary.empty() || isBoundary[static_cast<std::size_t>(i)]))
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
        if (isBoundary.empty()) {
            if (side(low[axis]).size() < kFewest || side(high[axis]).size() < kFewest) continue;
            rims = rimsOf(F);
            isBoundary.resize(static_cast<std::size_t>(V.rows()), false);
            for (const Rim& rim : rims) isBoundary[rim.i] = isBoundary[rim.j] = true;
        }
        const std::vector<Placed> a = side(low[axis]), b = side(high[axis]);
        if (a.size() < kFewest || a.size() != b.size()) continue;
        const std::size_t before = pairs.size();
        for (const Placed& one : a)
            if (const Index other = partner(one, b); other >= 0)
                pairs.push_back({one.second, other});
        const auto isIn = [&](const Rim& rim, double at) {
            return std::abs(V(rim.i, axis) - at) <= round && std::abs(V(rim.j, axis) - at) <= round;
        };
        const bool isWall = std::any_of(rims.begin(), rims.end(), [&](const Rim& rim) {
            return (isIn(rim, low[axis]) && V(rim.inner, axis) - low[axis] <= round) ||
                   (isIn(rim, high[axis]) && high[axis] - V(rim.inner, axis) <= round);
        });
        if (isWall || pairs.size() - before < a.size()) {
            pairs.resize(before);
            continue;
        }
        ++cells;
        isTube = std::all_of(rims.begin(), rims.end(), [&](const Rim& rim) {
            return isIn(rim, low[axis]) || isIn(rim, high[axis]);
        });
    }
    if (cells == 1 && isTube) pairs.clear();
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
