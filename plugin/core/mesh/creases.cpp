#include "core/mesh/creases.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/support/types.h"

namespace spectral {

std::vector<std::array<Index, 2>> creaseEdges(const Vertices& X, const Faces& F,
                                              const SidesByEdge& sides, double angle) {
    std::vector<std::array<Index, 2>> edges;
    if (angle >= 180.0) return edges;  // no fold is sharper
    const double sine = std::sin(angle * kPi / 180.0), cosine = std::cos(angle * kPi / 180.0);
    sides.forEachEdge([&](auto first, auto end) {
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
    for (const auto [i, j] : creaseEdges(X, F, SidesByEdge(F), angle))
        onCrease[i] = onCrease[j] = true;
    return onCrease;
}

std::vector<bool> alongSharpEdges(const Vertices& X, const Faces& F, const SidesByEdge& edges) {
    constexpr double kSharp = 50.0;  // degrees
    std::vector<int> counts(static_cast<std::size_t>(X.rows()), 0);
    for (const auto& [i, j] : creaseEdges(X, F, edges, kSharp)) {
        ++counts[i];
        ++counts[j];
    }
    std::vector<bool> along(counts.size());
    std::transform(counts.begin(), counts.end(), along.begin(), [](int n) { return n == 2; });
    return along;
}

RoundedCreases roundedCreases(const std::vector<bool>& alongEdges, const Vertices& displacement) {
    constexpr double kMore = 30.0;  // a statue's curls 15 times, a part by CAD 99, a wing 115
    constexpr std::size_t kFewest = 10;
    std::vector<double> on, off;
    double squares = 0.0;
    for (Index i = 0; i < displacement.rows(); ++i) {
        const double square = displacement.row(i).squaredNorm();
        (alongEdges[i] ? on : off).push_back(std::sqrt(square));
        if (alongEdges[i]) squares += square;
    }
    if (on.size() < kFewest || off.empty()) return {};
    const auto middle = off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2);
    std::nth_element(off.begin(), middle, off.end());
    if (!(std::sqrt(squares / static_cast<double>(on.size())) > kMore * *middle)) return {};
    return {static_cast<Index>(on.size()), *std::max_element(on.begin(), on.end())};
}

}  // namespace spectral
