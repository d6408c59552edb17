#include "core/mesh/measures.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "core/support/threads.h"

namespace spectral {

namespace {

std::vector<bool> usedBy(const Faces& F, Index n) {
    std::vector<bool> isUsed(static_cast<std::size_t>(n), false);
    for (const int i : F.reshaped()) isUsed[i] = true;
    return isUsed;
}

}  // namespace

double boundingBoxDiagonal(const Vertices& V) {
    return (V.colwise().maxCoeff() - V.colwise().minCoeff()).norm();
}

MeshLengths lengthsOf(const Vertices& V, const Faces& F) {
    using Position = Eigen::Vector3d;
    Eigen::AlignedBox3d all, surface;
    const auto extend = [&V](Eigen::AlignedBox3d& box, Index i) {
        const Position p = V.row(i).transpose();
        if (p.allFinite()) box.extend(p);
    };
    const auto diagonalOf = [](const Eigen::AlignedBox3d& box) {
        return box.isEmpty() ? 0.0 : box.sizes().norm();
    };
    MeshLengths lengths;
    lengths.filler = fillerOf(V, F);
    const std::vector<bool> isUsed = usedBy(F, V.rows());
    for (Index i = 0; i < V.rows(); ++i) {
        extend(all, i);
        if (isUsed[i] &&
            (lengths.filler.vertices == 0 || V(i, lengths.filler.axis) != lengths.filler.value))
            extend(surface, i);
    }
    lengths.meanEdge = meanEdgeLength(V, F);
    lengths.diagonal = diagonalOf(all);
    lengths.surfaceDiagonal = diagonalOf(surface.isEmpty() ? all : surface);
    if (!surface.isEmpty())
        for (Index i = 0; i < V.rows(); ++i)
            if (const Position p = V.row(i).transpose(); p.allFinite() && !surface.contains(p))
                ++lengths.outside;
    return lengths;
}

namespace {

/// The bounding box of the used vertices; coordinates that are no numbers are left out.
Eigen::AlignedBox3d boxOf(const Vertices& V, const std::vector<bool>& isUsed) {
    Eigen::AlignedBox3d box;
    for (Index i = 0; i < V.rows(); ++i)
        for (int c = 0; isUsed[i] && c < 3; ++c) {
            box.min()[c] = std::min(box.min()[c], V(i, c));
            box.max()[c] = std::max(box.max()[c], V(i, c));
        }
    return box;
}

/// The lowest of the used coordinates, times a sign, along an axis, and how many vertices have it;
/// none unless the others are farther from it than from each other, and those by more than the
/// round-off of a plane, which is 1e-7 of its size in single precision.
/// @param box  of the used vertices.
std::pair<double, Index> farthest(const Vertices& V, const std::vector<bool>& isUsed,
                                  const Eigen::AlignedBox3d& box, int axis, double sign) {
    constexpr double kRoundOff = 1e-6;
    const double lowest = std::min(sign * box.min()[axis], sign * box.max()[axis]),
                 highest = std::max(sign * box.min()[axis], sign * box.max()[axis]);
    double next = std::numeric_limits<double>::infinity();
    Index count = 0;
    for (Index i = 0; i < V.rows(); ++i) {
        if (!isUsed[i]) continue;
        const double at = sign * V(i, axis);
        if (at > lowest) {
            if (!(at - lowest > highest - at)) return {lowest, 0};  // soon, on most meshes
            next = std::min(next, at);
        }
        count += at == lowest;
    }
    Eigen::Vector3d plane = box.sizes();
    plane[axis] = 0.0;
    const double spread = highest - next;
    if (!(spread > kRoundOff * plane.norm()) || !(next - lowest > spread)) count = 0;
    return {lowest, count};
}

/// Whether each vertex is one of these, along any axis.
std::vector<bool> farVertices(const Vertices& V, const Faces& F) {
    const std::vector<bool> isUsed = usedBy(F, V.rows());
    const Eigen::AlignedBox3d box = boxOf(V, isUsed);
    std::vector<bool> isFar(isUsed.size(), false);
    for (const int axis : {0, 1, 2})
        for (const double sign : {1.0, -1.0}) {
            const auto [lowest, count] = farthest(V, isUsed, box, axis, sign);
            for (Index i = 0; count > 0 && i < V.rows(); ++i)
                if (isUsed[i] && sign * V(i, axis) == lowest) isFar[i] = true;
        }
    return isFar;
}

}  // namespace

double meanEdgeLength(const Vertices& V, const Faces& F) {
    // Walls around the cells of a terrain without data are 100 to 10,000 cells long, sides of parts
    // by CAD up to 48 and 215 times their median; but these lead to no vertices far from all
    // others.
    constexpr int kLonger = 6;        // by exponents of 2
    constexpr int kExponents = 2048;  // of doubles; the last is that of infinity
    const auto length = [&](Index t, int c) {
        return (V.row(F(t, (c + 1) % 3)) - V.row(F(t, c))).norm();
    };
    const auto exponentOf = [](double side) {
        std::uint64_t bits = 0;  // as std::frexp, without a call for each side
        std::memcpy(&bits, &side, sizeof bits);
        return static_cast<int>(bits >> 52 & 0x7ff);
    };
    double sum = 0.0;
    std::vector<Index> counts(kExponents, 0);
    for (Index t = 0; t < F.rows(); ++t)
        for (int c = 0; c < 3; ++c) {
            const double side = length(t, c);
            sum += side;
            ++counts[exponentOf(side)];
        }
    Index below = 0;
    int median = 0;
    while (median + 1 < kExponents && 2 * (below + counts[median]) < 3 * F.rows())
        below += counts[median++];
    Index longer = 0;
    for (int e = median + kLonger + 1; e < kExponents - 1; ++e) longer += counts[e];
    Index walls = 0;
    const std::vector<bool> isApart = longer > 0 ? farVertices(V, F) : std::vector<bool>();
    for (Index t = 0; longer > 0 && t < F.rows(); ++t)
        for (int c = 0; c < 3; ++c) {
            if (isApart[F(t, c)] == isApart[F(t, (c + 1) % 3)]) continue;
            const double side = length(t, c);
            if (exponentOf(side) <= median + kLonger) continue;
            sum -= side;
            ++walls;
        }
    return F.rows() > 0 ? sum / static_cast<double>(3 * F.rows() - walls) : 0.0;
}

MeshLengths::Filler fillerOf(const Vertices& V, const Faces& F) {
    const std::vector<bool> isUsed = usedBy(F, V.rows());
    const Eigen::AlignedBox3d box = boxOf(V, isUsed);
    for (const int axis : {2, 1, 0})
        for (const double sign : {1.0, -1.0}) {
            const auto [lowest, count] = farthest(V, isUsed, box, axis, sign);
            if (count < 2) continue;
            double all = 0.0, seen = 0.0;
            bool hasWall = false;
            for (Index t = 0; t < F.rows() && !hasWall; ++t) {
                const Eigen::RowVector3d a = V.row(F(t, 0)), b = V.row(F(t, 1)), c = V.row(F(t, 2));
                const double area = (b - a).cross(c - a)[axis];
                all += std::abs(area);
                seen += area;
                const double low = std::min({sign * a[axis], sign * b[axis], sign * c[axis]});
                hasWall = area == 0.0 && low == lowest;
            }
            if (!hasWall && std::abs(seen) > (1.0 - 1e-9) * all)
                return {axis, sign * lowest, count, sign > 0.0};
        }
    return {};
}

double defaultFeatureSize(double meanEdge, double diagonal) {
    const double size = 6.0 * meanEdge, bound = 0.05 * diagonal;
    return size > 0.0 && size < bound ? size : bound;
}

double defaultSmallestSize(double meanEdge, double diagonal) {
    return 0.5 * defaultFeatureSize(meanEdge, diagonal);
}

double surfaceArea(const Vertices& V, const Faces& F) {
    const double twiceArea = parallelSum(F.rows(), 0.0, [&](Index begin, Index end) {
        double sum = 0.0;
        for (Index t = begin; t < end; ++t) {
            const Eigen::RowVector3d a = V.row(F(t, 0)), b = V.row(F(t, 1)), c = V.row(F(t, 2));
            sum += (b - a).cross(c - a).norm();
        }
        return sum;
    });
    return 0.5 * twiceArea;
}

double signedVolume(const Vertices& V, const Faces& F) {
    // Tetrahedra with their apex at a distant origin would suffer from cancellation.
    const Eigen::RowVector3d o = 0.5 * (V.colwise().maxCoeff() + V.colwise().minCoeff());
    constexpr double kRoundOff = 1e-12;
    const Eigen::Vector2d zero = Eigen::Vector2d::Zero();  // sixfold volumes, and their moduli
    const Eigen::Vector2d sum = parallelSum(F.rows(), zero, [&](Index begin, Index end) {
        Eigen::Vector2d part = Eigen::Vector2d::Zero();
        for (Index t = begin; t < end; ++t) {
            const Eigen::RowVector3d a = V.row(F(t, 0)), b = V.row(F(t, 1)), c = V.row(F(t, 2));
            // By the edges: b x c would round off the area of what lies far from the others.
            const double volume = (a - o).dot((b - a).cross(c - a));
            part += Eigen::Vector2d(volume, std::abs(volume));
        }
        return part;
    });
    return std::abs(sum[0]) > kRoundOff * sum[1] ? sum[0] / 6.0 : 0.0;
}

bool enclosesVolume(const Vertices& V, const Faces& F) {
    constexpr double kRoundOff = 1e-9;
    const Eigen::RowVector3d low = V.colwise().minCoeff(), high = V.colwise().maxCoeff();
    const Eigen::RowVector3d o = 0.5 * (low + high);
    // Sums of (centroid, 1)^T (area vector, its length).
    const Eigen::Matrix4d zero = Eigen::Matrix4d::Zero();
    const Eigen::Matrix4d sum = parallelSum(F.rows(), zero, [&](Index begin, Index end) {
        Eigen::Matrix4d part = Eigen::Matrix4d::Zero();
        for (Index t = begin; t < end; ++t) {
            const Eigen::RowVector3d a = V.row(F(t, 0)) - o, b = V.row(F(t, 1)) - o,
                                     c = V.row(F(t, 2)) - o;
            const Eigen::RowVector3d normal = (b - a).cross(c - a);
            Eigen::Vector4d centroid;
            centroid << ((a + b + c) / 3.0).transpose(), 1.0;
            part.leftCols<3>() += centroid * normal;
            part.col(3) += centroid * normal.norm();
        }
        return part;
    });
    const double limit = kRoundOff * sum(3, 3);
    Eigen::Matrix3d moments = sum.topLeftCorner<3, 3>();
    moments.diagonal().array() -= moments.trace() / 3.0;
    return sum.row(3).head<3>().norm() <= limit && moments.norm() <= limit * (high - low).norm();
}

}  // namespace spectral
