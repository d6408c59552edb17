#include "core/noise/scan_rays.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/graph/diffusion.h"
#include "core/graph/robust_statistics.h"

namespace spectral {

namespace {

/// Number of different values, to a millionth.
Index valuesOf(const Eigen::ArrayXd& values) {
    constexpr double kEqual = 1e-6;
    Eigen::ArrayXd rounded = (values / kEqual).round();
    std::sort(rounded.begin(), rounded.end());
    return std::unique(rounded.begin(), rounded.end()) - rounded.begin();
}

/// Whether the vertices, relative to the eye, are the pixels of a depth camera that looks along an
/// axis: there are few slopes, or few depths. Scans of lasers have as many as vertices.
bool arePixels(const Points& fromEye) {
    constexpr Index kPerSlope = 8, kPerDepth = 20;  // vertices
    for (int axis = 0; axis < 3; ++axis) {
        const Eigen::ArrayXd depth = fromEye.col(axis);
        if (!(depth.minCoeff() > 0.0 || depth.maxCoeff() < 0.0)) continue;
        if (valuesOf(depth / depth.abs().maxCoeff()) * kPerDepth < depth.size()) return true;
        Index slopes = 0;
        for (int other = 0; other < 3; ++other)
            if (other != axis)
                slopes = std::max(slopes, valuesOf(fromEye.col(other).array() / depth));
        if (slopes * kPerSlope < depth.size()) return true;
    }
    return false;
}

/// Unit vectors from the eye, if a surface looks as a camera there has seen it; else no rows.
Points raysFrom(const Eigen::RowVector3d& eye, const FaceGraph& graph, const Points& X) {
    constexpr double kMinSeen = 0.995;  // share of the faces
    const bool isInside = (eye.array() >= X.colwise().minCoeff().array()).all() &&
                          (eye.array() <= X.colwise().maxCoeff().array()).all();
    if (isInside) return {};
    Points rays = X.rowwise() - eye;
    normalizeRows(rays);
    const Points N = areaNormals(X, graph.F);
    Index seen = 0;
    for (Index f = 0; f < N.rows(); ++f) seen += N.row(f).dot(rays.row(graph.F(f, 0))) > 0.0;
    const double share = static_cast<double>(seen) / static_cast<double>(N.rows());
    if (std::max(share, 1.0 - share) < kMinSeen) return {};
    return rays;
}

/// The first principal direction of what alternates in the positions; no rows if it is not the
/// direction of a scan.
Points directionOfResiduals(const FaceGraph& graph, const Points& X,
                            const std::vector<bool>& isMeasured) {
    // Single scans have 3.2 to 12, all else 1.0 to 1.9.
    constexpr double kMinRatio = 3.0;
    constexpr double kMinSeen = 0.9;  // of the area, less what is seen from behind
    constexpr double kTrimmed = 0.95;
    Points residual = Points::Zero(X.rows(), 3), second = residual;
    forEachMean(graph.vertices, X,
                [&](Index i, const auto& mean) { residual.row(i) = X.row(i) - mean; });
    forEachMean(graph.vertices, residual,
                [&](Index i, const auto& mean) { second.row(i) = residual.row(i) - mean; });
    std::vector<double> lengths;
    for (Index i = 0; i < X.rows(); ++i)
        if (isMeasured[i]) lengths.push_back(second.row(i).norm());
    const double limit = quantile(std::move(lengths), kTrimmed);
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    for (Index i = 0; i < X.rows(); ++i)
        if (isMeasured[i] && second.row(i).norm() < limit)
            squares += second.row(i).transpose() * second.row(i);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(squares);
    const Eigen::Vector3d& variance = axes.eigenvalues();
    if (!(variance[2] > kMinRatio * kMinRatio * variance[1])) return {};
    const Eigen::RowVector3d direction = axes.eigenvectors().col(2).transpose();
    const Eigen::VectorXd seen = areaNormals(X, graph.F) * direction.transpose();
    if (!(std::abs(seen.sum()) > kMinSeen * seen.cwiseAbs().sum())) return {};
    return direction.replicate(X.rows(), 1);
}

}  // namespace

ScanRays scanRays(const Eigen::RowVector3d& eye, const FaceGraph& graph, const Points& X,
                  const std::vector<bool>& isMeasured, bool isCorrelated) {
    if (std::find(graph.onRim.begin(), graph.onRim.end(), true) == graph.onRim.end()) return {};
    Points rays = raysFrom(eye, graph, X);
    const bool isSeen = rays.rows() > 0;
    if (isSeen && arePixels(X.rowwise() - eye)) return {std::move(rays), true};
    Points direction = directionOfResiduals(graph, X, isMeasured);
    if (isSeen && isCorrelated && direction.rows() == 0) return {std::move(rays), true};
    return {std::move(direction), false};
}

}  // namespace spectral
