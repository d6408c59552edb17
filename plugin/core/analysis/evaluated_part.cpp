#include "core/analysis/evaluated_part.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <tuple>

#include "core/mesh/sides.h"
#include "core/mesh/union_find.h"
#include "core/support/types.h"

namespace spectral {

namespace {

/// The angle of a triangle at a corner; 0 if it has sides of no length.
double angleAt(const Vertices& X, const Faces& F, Index t, int corner) {
    const Eigen::RowVector3d a = X.row(F(t, (corner + 1) % 3)) - X.row(F(t, corner));
    const Eigen::RowVector3d b = X.row(F(t, (corner + 2) % 3)) - X.row(F(t, corner));
    return std::atan2(a.cross(b).norm(), a.dot(b));
}

double distanceToEdge(const Vertices& X, Index i, const EdgeVertices& edge) {
    const Eigen::RowVector3d a = X.row(edge[0]), d = X.row(edge[1]) - a, p = X.row(i) - a;
    const double squared = d.squaredNorm();
    const double at = squared > 0.0 ? std::clamp(p.dot(d) / squared, 0.0, 1.0) : 0.0;
    return (p - at * d).norm();
}

}  // namespace

Outline outlineOf(const Surface& surface, double largestHole) {
    const Vertices& X = surface.X;
    const Faces& F = surface.F;
    std::vector<EdgeVertices> edges;
    UnionFind loops(X.rows());
    std::vector<bool> onBoundary(static_cast<std::size_t>(X.rows()), false);
    SidesByEdge(F).forEachEdge([&](auto first, auto end) {
        if (end - first != 1) return;
        const int t = first->face(), c = first->corner();
        edges.push_back({F(t, c), F(t, (c + 1) % 3)});
        loops.unite(first->low, first->high);
        onBoundary[first->low] = onBoundary[first->high] = true;
    });
    const std::vector<int> loop = loops.roots();
    Eigen::VectorXd turning = Eigen::VectorXd::Zero(X.rows());  // of each loop, radians
    std::vector<Eigen::AlignedBox3d> boxes(onBoundary.size());
    for (const auto& [i, j] : edges) {
        turning[loop[i]] += kPi;
        for (const Index k : {i, j}) boxes[loop[k]].extend(X.row(k).transpose());
    }
    for (Index t = 0; t < F.rows(); ++t)
        for (int corner = 0; corner < 3; ++corner)
            if (const int i = F(t, corner); onBoundary[i])
                turning[loop[i]] -= angleAt(X, F, t, corner);
    Outline outline;
    std::vector<int> number(onBoundary.size(), -1);  // of the hole of a loop
    for (const EdgeVertices& edge : edges) {
        const int one = loop[edge[0]];
        if (turning[one] >= -kPi || boxes[one].diagonal().norm() > largestHole) {
            outline.ends.push_back(edge);
            continue;
        }
        if (number[one] < 0) number[one] = outline.count++;
        outline.holes.push_back(edge);
        outline.hole.push_back(number[one]);
    }
    return outline;
}

Eigen::MatrixXd bridged(const Eigen::MatrixXd& values, const Outline& outline) {
    const Index n = values.rows();
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(n + outline.count, values.cols());
    all.topRows(n) = values;
    Eigen::VectorXd counts = Eigen::VectorXd::Zero(outline.count);
    for (std::size_t k = 0; k < outline.holes.size(); ++k)
        for (const Index i : outline.holes[k]) {
            all.row(n + outline.hole[k]) += values.row(i);
            counts[outline.hole[k]] += 1.0;
        }
    for (int hole = 0; hole < outline.count; ++hole) all.row(n + hole) /= counts[hole];
    return all;
}

Surface bridged(Surface surface, const Outline& outline) {
    const Index m = surface.F.rows();
    const auto n = static_cast<int>(surface.X.rows());
    surface.X = bridged(Eigen::MatrixXd(surface.X), outline);
    surface.F.conservativeResize(m + static_cast<Index>(outline.holes.size()), 3);
    surface.vertex.resize(static_cast<std::size_t>(surface.X.rows()));
    for (std::size_t k = 0; k < outline.holes.size(); ++k) {
        const auto [i, j] = outline.holes[k];
        const int middle = n + outline.hole[k];
        surface.F.row(m + static_cast<Index>(k)) << static_cast<int>(j), static_cast<int>(i),
            middle;
        surface.vertex[middle] = surface.vertex[i];
    }
    return surface;
}

/// Dijkstra's algorithm, except that each vertex knows its nearest end, an edge, and measures
/// straight to it: paths along edges would depend on how the surface is meshed.
std::vector<bool> farFrom(const std::vector<EdgeVertices>& edges, const Surface& surface,
                          const SparseMatrix& W, double distance) {
    const std::size_t n = static_cast<std::size_t>(surface.X.rows());
    std::vector<bool> isFar(n, true);
    if (distance <= 0.0) return isFar;
    std::vector<double> nearest(n, std::numeric_limits<double>::infinity());
    for (const EdgeVertices& edge : edges)
        for (const Index i : edge) nearest[i] = 0.0;
    using Visit = std::tuple<double, Index, std::size_t>;  // distance, vertex, edge
    std::priority_queue<Visit, std::vector<Visit>, std::greater<>> next;
    const auto reachNeighbours = [&](Index i, std::size_t edge) {
        for (SparseMatrix::InnerIterator entry(W, i); entry; ++entry) {
            const Index j = entry.index();
            if (nearest[j] == 0.0) continue;
            const double straight = distanceToEdge(surface.X, j, edges[edge]);
            if (straight > distance || straight >= nearest[j]) continue;
            nearest[j] = straight;
            next.emplace(straight, j, edge);
        }
    };
    for (std::size_t edge = 0; edge < edges.size(); ++edge)
        for (const Index i : edges[edge]) reachNeighbours(i, edge);
    while (!next.empty()) {
        const auto [straight, i, edge] = next.top();
        next.pop();
        if (straight == nearest[i]) reachNeighbours(i, edge);
    }
    for (std::size_t i = 0; i < n; ++i) isFar[i] = nearest[i] > distance;
    return isFar;
}

}  // namespace spectral
