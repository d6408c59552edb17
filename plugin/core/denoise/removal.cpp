#include "core/denoise/removal.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/denoise/linear_steps.h"
#include "core/denoise/normal_filter.h"
#include "core/denoise/unfold.h"
#include "core/denoise/vertex_update.h"
#include "core/denoise/whiteness.h"
#include "core/noise/robust_statistics.h"

namespace spectral {

namespace {

/// Largest displacement of a vertex, in standard deviations of the noise.
constexpr double kMaxDeviations = 6.0;
const char* const kStage = "removing the noise";

/// The height of the noise removed by moving the vertices from X0 to X, from the median.
double removedHeight(const Points& X0, const Points& X, const std::vector<bool>& mayMove) {
    std::vector<double> displacements;
    for (Index i = 0; i < X.rows(); ++i)
        if (mayMove[i]) displacements.push_back((X.row(i) - X0.row(i)).norm());
    return medianDeviation(std::move(displacements));
}

/// Limits displacements to `limit`: where triangles are narrower than the height of the noise,
/// normals are unreliable.
void limitDisplacement(const Points& X0, double limit, Points& X) {
    for (Index i = 0; i < X.rows(); ++i) {
        const Eigen::RowVector3d displacement = X.row(i) - X0.row(i);
        const double length = displacement.norm();
        if (length > limit) X.row(i) = X0.row(i) + limit / length * displacement;
    }
}

double maxDisplacement(const RemovalOptions& options, double deviations) {
    const double edges = options.areImpulses ? 3.0 : 0.3;
    return std::max(deviations * options.height, edges * options.meanEdge);
}

/// Unfolds faces, within the limit of all displacements.
void finish(const FaceGraph& graph, const Points& X0, const Points& N,
            const RemovalOptions& options, Points& X) {
    constexpr double kMaxAlongSurface = 5.0;  // heights of the noise
    unfoldFaces(graph, N, kMaxAlongSurface * options.height, options.mayMove, X);
    limitDisplacement(X0, maxDisplacement(options, kMaxDeviations), X);
}

double edgeScale(const RemovalOptions& options, double scale) {
    return options.keepCreases ? scale : std::numeric_limits<double>::infinity();
}

NormalFilterOptions filterOfLength(double length, const RemovalOptions& options) {
    constexpr double kTime = 1.5, kEdgeScale = 0.22, kBlurs = 2.0;
    return {kTime * length * length, edgeScale(options, kEdgeScale), 0.0,
            static_cast<int>(kBlurs * length * length), false};
}

int sweepsOfLength(double length) {
    constexpr double kSweeps = 12.0;
    return static_cast<int>(std::lround(kSweeps * length));
}

}  // namespace

Removal removeWhiteNoise(const FaceGraph& graph, const Points& X0, const RemovalOptions& options,
                         const Progress& progress) {
    struct Round {
        double time;
        int sweeps;
        double edgeScale;
    };
    constexpr Round kWeak{4.0, 16, 0.25}, kStrong{8.0, 32, 0.22};
    constexpr int kWeakRounds = 6, kMaxRounds = 10;
    constexpr double kHalfTimeAt = 0.13;  // height in mean edges; weaker noise gets weaker rounds
    constexpr double kMaxRemoved = 1.03;  // multiple of the height
    constexpr double kMaxSmoothness = 0.957, kFirstSmoothness = 0.76, kColour = 0.75;
    constexpr double kMaxDeviationsPerRound = 3.0;

    progress.report(0.0, kStage);
    if (std::optional<LinearSteps> linear = linearSteps(
            graph, X0, options.mayMove, options.height / options.meanEdge, options.areImpulses)) {
        finish(graph, X0, linear->N, options, linear->X);
        return {std::move(linear->X), linear->steps};
    }

    const double limit = maxDisplacement(options, kMaxDeviationsPerRound);
    const double weaker = 1.0 + std::pow(kHalfTimeAt * options.meanEdge / options.height, 3);
    Removal removal{X0, 0};
    Points N;
    double maxSmoothness = 0.0;
    while (removal.rounds < kMaxRounds) {
        progress.report(double(removal.rounds) / kMaxRounds, kStage);
        const Round& round = removal.rounds < kWeakRounds ? kWeak : kStrong;
        const Points next = filterNormals(graph, removal.X,
                                          {round.time / weaker, edgeScale(options, round.edgeScale),
                                           options.height / options.meanEdge, 2, true},
                                          N);
        Points X = followNormals(graph, X0, next, options.mayMove, round.sweeps);
        limitDisplacement(X0, limit, X);
        const double smooth = smoothness(graph.vertices, displacementAlongNormals(graph, X0, X));
        if (removal.rounds == 0)
            maxSmoothness =
                kMaxSmoothness * std::pow(std::max(1.0, smooth / kFirstSmoothness), kColour);
        else if (smooth > maxSmoothness)
            break;
        N = next;
        removal.X = X;
        ++removal.rounds;
        if (removedHeight(X0, X, options.mayMove) > kMaxRemoved * options.height) break;
    }
    finish(graph, X0, N, options, removal.X);
    return removal;
}

Removal removeCorrelatedNoise(const FaceGraph& graph, const Points& X0,
                              const RemovalOptions& options, const Progress& progress) {
    constexpr double kLength = 0.8, kMaxLength = 4.0;
    constexpr double kMinRemoved = 0.8;  // part of the height; the rest is as long as details
    constexpr int kMinRounds = 2, kMaxRounds = 6;
    const double length = std::min(kLength * options.size, kMaxLength);
    const double limit = maxDisplacement(options, kMaxDeviations);
    Removal removal{X0, 0};
    Points N;
    double removed = 0.0;
    while (removal.rounds < kMinRounds ||
           (removed < kMinRemoved * options.height && removal.rounds < kMaxRounds)) {
        progress.report(double(removal.rounds) / kMaxRounds, kStage);
        N = filterNormals(graph, removal.X, filterOfLength(length, options), N);
        removal.X = followNormals(graph, X0, N, options.mayMove, sweepsOfLength(length));
        removed = removedHeight(X0, removal.X, options.mayMove);
        limitDisplacement(X0, limit, removal.X);
        ++removal.rounds;
    }
    finish(graph, X0, N, options, removal.X);
    return removal;
}

Removal removeVoxelSteps(const FaceGraph& graph, const Points& X0, const Eigen::RowVector3d& voxel,
                         const RemovalOptions& options, const Progress& progress) {
    constexpr double kLength = 1.5, kThickness = 0.5;
    constexpr int kRounds = 3;
    // For thick slices, the filter works in units between lengths and voxels.
    const Eigen::RowVector3d scale =
        (voxel.minCoeff() * voxel.cwiseInverse()).array().pow(kThickness);
    const Eigen::RowVector3d half = 0.5 * voxel.cwiseProduct(scale);
    const Points start = X0 * scale.asDiagonal();
    Removal removal{start, 0};
    while (removal.rounds < kRounds) {
        progress.report(double(removal.rounds) / kRounds, kStage);
        const Points N = filterNormals(graph, removal.X, filterOfLength(kLength, options));
        removal.X = followNormals(graph, start, N, options.mayMove, sweepsOfLength(kLength));
        for (Index i = 0; i < start.rows(); ++i)
            removal.X.row(i) =
                removal.X.row(i).cwiseMax(start.row(i) - half).cwiseMin(start.row(i) + half);
        ++removal.rounds;
    }
    // Add to X0, so that a vertex that has not moved stays bit-identical.
    removal.X = X0 + (removal.X - start) * scale.cwiseInverse().asDiagonal();
    return removal;
}

}  // namespace spectral
