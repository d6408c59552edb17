#include "core/mesh/measures.h"

#include <Eigen/Geometry>

#include "core/support/threads.h"

namespace spectral {

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
    for (Index i = 0; i < V.rows(); ++i) extend(all, i);
    for (Index t = 0; t < F.rows(); ++t)
        for (int c = 0; c < 3; ++c) extend(surface, F(t, c));
    MeshLengths lengths;
    lengths.meanEdge = meanEdgeLength(V, F);
    lengths.diagonal = diagonalOf(all);
    lengths.surfaceDiagonal = diagonalOf(surface.isEmpty() ? all : surface);
    if (!surface.isEmpty())
        for (Index i = 0; i < V.rows(); ++i)
            if (const Position p = V.row(i).transpose(); p.allFinite() && !surface.contains(p))
                ++lengths.outside;
    return lengths;
}

double meanEdgeLength(const Vertices& V, const Faces& F) {
    double sum = 0.0;
    for (Index t = 0; t < F.rows(); ++t)
        for (int c = 0; c < 3; ++c) sum += (V.row(F(t, (c + 1) % 3)) - V.row(F(t, c))).norm();
    return F.rows() > 0 ? sum / (3.0 * static_cast<double>(F.rows())) : 0.0;
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
    const double sixfoldVolume = parallelSum(F.rows(), 0.0, [&](Index begin, Index end) {
        double sum = 0.0;
        for (Index t = begin; t < end; ++t) {
            const Eigen::RowVector3d a = V.row(F(t, 0)) - o, b = V.row(F(t, 1)) - o,
                                     c = V.row(F(t, 2)) - o;
            sum += a.dot(b.cross(c));
        }
        return sum;
    });
    return sixfoldVolume / 6.0;
}

bool enclosesVolume(const Vertices& V, const Faces& F) {
    constexpr double kRoundOff = 1e-9;
    const Eigen::Vector4d zero = Eigen::Vector4d::Zero();  // sum of area vectors, and of lengths
    const Eigen::Vector4d sum = parallelSum(F.rows(), zero, [&](Index begin, Index end) {
        Eigen::Vector4d part = Eigen::Vector4d::Zero();
        for (Index t = begin; t < end; ++t) {
            const Eigen::RowVector3d a = V.row(F(t, 0)), b = V.row(F(t, 1)), c = V.row(F(t, 2));
            const Eigen::RowVector3d normal = (b - a).cross(c - a);
            part.head<3>() += normal.transpose();
            part[3] += normal.norm();
        }
        return part;
    });
    return sum.head<3>().norm() <= kRoundOff * sum[3];
}

}  // namespace spectral
