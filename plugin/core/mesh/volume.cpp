#include "core/mesh/volume.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/mesh/measures.h"
#include "core/mesh/sides.h"

namespace spectral {

namespace {

/// The triangles of each component.
std::vector<Faces> facesByComponent(const Faces& F, const Components& components) {
    std::vector<Index> count(static_cast<std::size_t>(components.count), 0);
    for (Index t = 0; t < F.rows(); ++t) ++count[components.label[F(t, 0)]];
    std::vector<Faces> faces;
    for (const Index size : count) faces.emplace_back(size, 3);
    for (Index t = F.rows() - 1; t >= 0; --t) {
        const int c = components.label[F(t, 0)];
        faces[c].row(--count[c]) = F.row(t);
    }
    return faces;
}

/// Whether every edge is traversed equally often in both directions.
bool isClosed(const Faces& F) {
    bool isBalanced = true;
    SidesByEdge(F).forEachEdge([&](auto first, auto end) {
        int balance = 0;
        for (auto side = first; side != end; ++side)
            balance += F(side->face(), side->corner()) == side->low ? 1 : -1;
        isBalanced = isBalanced && balance == 0;
    });
    return isBalanced;
}

/// Gradient of six times the volume of a closed surface, n x 3: along the normals.
Vertices volumeGradient(const Vertices& X, const Faces& F) {
    Vertices gradient = Vertices::Zero(X.rows(), 3);
    for (Index t = 0; t < F.rows(); ++t)
        for (int c = 0; c < 3; ++c) {
            const Eigen::RowVector3d a = X.row(F(t, (c + 1) % 3)), b = X.row(F(t, (c + 2) % 3));
            gradient.row(F(t, c)) += a.cross(b);
        }
    return gradient;
}

/// Offsets a closed component to the given volume; returns false if that fails.
bool offsetTo(double volume, const Faces& F, const Eigen::VectorXd& weight, Vertices& X) {
    constexpr int kMaxSteps = 50;
    constexpr double kAccuracy = 1e-12;
    for (int step = 0; step < kMaxSteps; ++step) {
        const double missing = volume - signedVolume(X, F);
        if (std::abs(missing) <= kAccuracy * std::abs(volume)) return true;
        // Newton's method, along the current normals.
        const Vertices gradient = volumeGradient(X, F);
        const Eigen::VectorXd length = gradient.rowwise().norm();
        const double slope = length.dot(weight) / 6.0;
        const Eigen::VectorXd offset =
            (length.array() > 0.0).select(missing / slope * weight.array() / length.array(), 0.0);
        if (!offset.allFinite()) return false;
        X += offset.asDiagonal() * gradient;
    }
    return false;
}

}  // namespace

PreservedVolumes preserveVolumes(const Vertices& X0, const Faces& F, const Components& components,
                                 const Eigen::VectorXd& weight, double maxOffset, Vertices& X) {
    constexpr double kRoundOff = 1e-9;  // displacement that compensates round-off of the volume
    PreservedVolumes volumes;
    for (const Faces& component : facesByComponent(F, components)) {
        if (!isClosed(component)) {
            ++volumes.open;
            continue;
        }
        const Surface before = surfaceOf(X, component);  // the component alone, near the origin
        Eigen::VectorXd localWeight(before.X.rows());
        double limit = kRoundOff * before.X.cwiseAbs().maxCoeff();
        for (Index i = 0; i < localWeight.size(); ++i) {
            const Index v = before.vertex[i];
            localWeight[i] = weight[v];
            limit = std::max(limit, maxOffset * (X.row(v) - X0.row(v)).norm());
        }
        Vertices moved = before.X;
        if (!offsetTo(signedVolume(X0, component), before.F, localWeight, moved) ||
            (moved - before.X).rowwise().norm().maxCoeff() > limit) {
            ++volumes.lost;
            continue;
        }
        ++volumes.preserved;
        for (Index i = 0; i < localWeight.size(); ++i)
            if (localWeight[i] > 0.0) X.row(before.vertex[i]) += moved.row(i) - before.X.row(i);
    }
    return volumes;
}

}  // namespace spectral
