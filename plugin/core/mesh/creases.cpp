#include "core/mesh/creases.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/mesh/sides.h"
#include "core/support/types.h"

namespace spectral {

std::vector<std::array<Index, 2>> creaseEdges(const Vertices& X, const Faces& F, double angle) {
    std::vector<std::array<Index, 2>> edges;
    if (angle >= 180.0) return edges;  // no fold is sharper
    const double sine = std::sin(angle * kPi / 180.0), cosine = std::cos(angle * kPi / 180.0);
    SidesByEdge(F).forEachEdge([&](auto first, auto end) {
        const Eigen::RowVector3d origin = X.row(first->low);
        const Eigen::RowVector3d edge = X.row(first->high) - origin;
        const auto corner = [&](auto side) { return F(side->face(), side->opposite()); };
        const auto isFold = [&](auto side, auto other) {
            // Normals of both triangles as seen from one side of the surface.
            const Eigen::RowVector3d a = edge.cross(X.row(corner(side)) - origin);
            const Eigen::RowVector3d b = (X.row(corner(other)) - origin).cross(edge);
            return a.cross(b).norm() * cosine > a.dot(b) * sine;
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

RoundedCreases roundedCreases(const Vertices& X, const Faces& F, const Vertices& displacement) {
    constexpr double kSharp = 50.0;  // degrees
    constexpr double kMore = 30.0;   // a statue's curls 15 times, a part by CAD 99, a wing 115
    constexpr std::size_t kFewest = 10;
    std::vector<int> edges(static_cast<std::size_t>(X.rows()), 0);
    for (const auto& [i, j] : creaseEdges(X, F, kSharp)) {
        ++edges[i];
        ++edges[j];
    }
    std::vector<double> on, off;
    double squares = 0.0;
    for (Index i = 0; i < X.rows(); ++i) {
        const double square = displacement.row(i).squaredNorm();
        (edges[i] == 2 ? on : off).push_back(std::sqrt(square));
        if (edges[i] == 2) squares += square;
    }
    if (on.size() < kFewest || off.empty()) return {};
    const auto middle = off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2);
    std::nth_element(off.begin(), middle, off.end());
    if (!(std::sqrt(squares / static_cast<double>(on.size())) > kMore * *middle)) return {};
    return {static_cast<Index>(on.size()), *std::max_element(on.begin(), on.end())};
}

}  // namespace spectral
