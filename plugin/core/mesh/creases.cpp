#include "core/mesh/creases.h"

#include <Eigen/Geometry>
#include <cmath>

#include "core/mesh/sides.h"
#include "core/support/types.h"

namespace spectral {

std::vector<std::array<Index, 2>> creaseEdges(const Vertices& X, const Faces& F, double angle) {
    std::vector<std::array<Index, 2>> edges;
    SidesByEdge(F).forEachEdge([&](auto first, auto end) {
        const Eigen::RowVector3d origin = X.row(first->low);
        const Eigen::RowVector3d edge = X.row(first->high) - origin;
        const auto corner = [&](auto side) { return F(side->face(), side->opposite()); };
        const auto isFold = [&](auto side, auto other) {
            // Normals of both triangles as seen from one side of the surface.
            const Eigen::RowVector3d a = edge.cross(X.row(corner(side)) - origin);
            const Eigen::RowVector3d b = (X.row(corner(other)) - origin).cross(edge);
            return std::atan2(a.cross(b).norm(), a.dot(b)) > angle * kPi / 180.0;
        };
        const bool isPair = end - first == 2;
        for (auto side = first; side != end; ++side)
            for (auto other = first; other != side; ++other)
                // A triangle twice among others is no fold: the second side of a sheet, for one.
                if ((isPair || corner(side) != corner(other)) && isFold(side, other)) {
                    edges.push_back({first->low, first->high});
                    return;
                }
    });
    return edges;
}

std::vector<bool> creaseVertices(const Vertices& X, const Faces& F, double angle) {
    std::vector<bool> onCrease(static_cast<std::size_t>(X.rows()), false);
    for (const auto [i, j] : creaseEdges(X, F, angle)) onCrease[i] = onCrease[j] = true;
    return onCrease;
}

}  // namespace spectral
