#include "core/mesh/movement.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/mesh/measures.h"
#include "core/support/threads.h"

namespace spectral {

namespace {

/// Twice the area of a face, along its normal.
Eigen::RowVector3d areaVector(const Vertices& X, const Faces& F, Index t) {
    const Eigen::RowVector3d a = X.row(F(t, 0)), b = X.row(F(t, 1)), c = X.row(F(t, 2));
    return (b - a).cross(c - a);
}

}  // namespace

Movement movementOf(const Vertices& X, const Faces& F, const Vertices& displacement,
                    const Eigen::VectorXd& weight, const PreservedVolumes& volumes) {
    const Eigen::VectorXd squares = displacement.rowwise().squaredNorm();
    Movement movement;
    movement.maxDisplacement = std::sqrt(squares.maxCoeff());
    movement.rmsDisplacement = std::sqrt(squares.dot(weight / weight.sum()));
    movement.meanDisplacement = squares.cwiseSqrt().dot(weight / weight.sum());
    movement.volumeBefore = signedVolume(X, F);
    const Vertices moved = X + displacement;
    movement.volumeAfter = signedVolume(moved, F);
    movement.hasVolume = enclosesVolume(X, F);
    movement.volumes = volumes;
    movement.foldedFaces = foldedFaces(X, moved, F);
    return movement;
}

Index foldedFaces(const Vertices& before, const Vertices& after, const Faces& F) {
    constexpr double kSmall = 0.01;
    const double small = kSmall * 2.0 * surfaceArea(after, F) / static_cast<double>(F.rows());
    std::vector<char> hasTurned(static_cast<std::size_t>(F.rows()));
    parallelRows(F.rows(), [&](Index begin, Index end) {
        for (Index t = begin; t < end; ++t) {
            const Eigen::RowVector3d now = areaVector(after, F, t);
            hasTurned[t] = now.dot(areaVector(before, F, t)) < 0.0 && now.norm() > small;
        }
    });
    if (std::find(hasTurned.begin(), hasTurned.end(), 1) == hasTurned.end()) return 0;
    Vertices around = Vertices::Zero(after.rows(), 3);
    for (Index t = 0; t < F.rows(); ++t)
        for (int c = 0; c < 3; ++c) around.row(F(t, c)) += areaVector(after, F, t);
    Index count = 0;
    for (Index t = 0; t < F.rows(); ++t) {
        if (!hasTurned[t]) continue;
        const Eigen::RowVector3d own = areaVector(after, F, t);
        Eigen::RowVector3d others = -3.0 * own;
        for (int c = 0; c < 3; ++c) others += around.row(F(t, c));
        if (others.dot(own) < 0.0) ++count;
    }
    return count;
}

double largestAtSeams(const Vertices& V, const Vertices& moved, const Surface& surface) {
    double largest = 0.0;
    for (const auto& [vertex, row] : surface.copies)
        for (const Index i : {vertex, surface.vertex[row]})
            largest = std::max(largest, (moved.row(i) - V.row(i)).norm());
    return largest;
}

}  // namespace spectral
