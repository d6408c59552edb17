#include "core/mesh/creases.h"

#include <Eigen/Geometry>
#include <cmath>

#include "core/mesh/sides.h"
#include "core/support/types.h"

namespace spectral {

std::vector<bool> creaseVertices(const Vertices& X, const Faces& F, double angle) {
    std::vector<bool> onCrease(static_cast<std::size_t>(X.rows()), false);
    SidesByEdge(F).forEachEdge([&](auto first, auto end) {
        if (end - first != 2) return;
        const auto corner = [&](auto side) { return X.row(F(side->face(), side->opposite())); };
        const Eigen::RowVector3d origin = X.row(first->low);
        const Eigen::RowVector3d edge = X.row(first->high) - origin;
        const Eigen::RowVector3d a = edge.cross(corner(first) - origin);
        const Eigen::RowVector3d b = (corner(first + 1) - origin).cross(edge);
        // Normals of both triangles as seen from one side of the surface.
        if (std::atan2(a.cross(b).norm(), a.dot(b)) > angle * kPi / 180.0)
            onCrease[first->low] = onCrease[first->high] = true;
    });
    return onCrease;
}

}  // namespace spectral
