#include "core/mesh/creases.h"

#include <Eigen/Geometry>
#include <cmath>

#include "core/mesh/sides.h"
#include "core/support/types.h"

namespace spectral {

std::vector<std::array<Index, 2>> creaseEdges(const Vertices& X, const Faces& F, double angle) {
    std::vector<std::array<Index, 2>> edges;
    SidesByEdge(F).forEachEdge([&](auto first, auto end) {
        if (end - first != 2) return;
        const auto corner = [&](auto side) { return X.row(F(side->face(), side->opposite())); };
        const Eigen::RowVector3d origin = X.row(first->low);
        const Eigen::RowVector3d edge = X.row(first->high) - origin;
        const Eigen::RowVector3d a = edge.cross(corner(first) - origin);
        const Eigen::RowVector3d b = (corner(first + 1) - origin).cross(edge);
        // Normals of both triangles as seen from one side of the surface.
        if (std::atan2(a.cross(b).norm(), a.dot(b)) > angle * kPi / 180.0)
            edges.push_back({first->low, first->high});
    });
    return edges;
}

std::vector<bool> creaseVertices(const Vertices& X, const Faces& F, double angle) {
    std::vector<bool> onCrease(static_cast<std::size_t>(X.rows()), false);
    for (const auto [i, j] : creaseEdges(X, F, angle)) onCrease[i] = onCrease[j] = true;
    return onCrease;
}

}  // namespace spectral
