#include "core/mesh/creases.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/support/types.h"

namespace spectral {

namespace {

/// A side of a triangle, and the corner opposite to it.
struct Side {
    int low, high, opposite;
    bool isOfEdge(const Side& other) const { return low == other.low && high == other.high; }
    bool operator<(const Side& other) const {
        return std::tie(low, high) < std::tie(other.low, other.high);
    }
};

}  // namespace

std::vector<bool> creaseVertices(const Vertices& X, const Faces& F, double angle) {
    std::vector<Side> sides;
    sides.reserve(static_cast<std::size_t>(3 * F.rows()));
    for (Index t = 0; t < F.rows(); ++t)
        for (int c = 0; c < 3; ++c) {
            const auto [low, high] = std::minmax({F(t, c), F(t, (c + 1) % 3)});
            sides.push_back({low, high, F(t, (c + 2) % 3)});
        }
    std::sort(sides.begin(), sides.end());

    std::vector<bool> onCrease(static_cast<std::size_t>(X.rows()), false);
    for (auto first = sides.begin(); first != sides.end();) {
        const auto next = std::find_if(first, sides.end(),
                                       [&](const Side& side) { return !side.isOfEdge(*first); });
        if (next - first == 2) {
            const Eigen::RowVector3d origin = X.row(first->low);
            const Eigen::RowVector3d edge = X.row(first->high) - origin;
            const Eigen::RowVector3d a = edge.cross(X.row(first->opposite) - origin);
            const Eigen::RowVector3d b = (X.row((first + 1)->opposite) - origin).cross(edge);
            // Normals of both triangles as seen from one side of the surface.
            if (std::atan2(a.cross(b).norm(), a.dot(b)) > angle * kPi / 180.0)
                onCrease[first->low] = onCrease[first->high] = true;
        }
        first = next;
    }
    return onCrease;
}

}  // namespace spectral
