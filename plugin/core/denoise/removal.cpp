#include "core/denoise/removal.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/denoise/least_risk.h"
#include "core/denoise/linear_steps.h"
#include "core/denoise/normal_filter.h"
#include "core/denoise/unfold.h"
#include "core/denoise/vertex_update.h"
#include "core/denoise/whiteness.h"
#include "core/graph/local_average.h"
#include "core/graph/robust_statistics.h"

namespace spectral {

namespace {

/// Largest displacement of a vertex, in standard deviations of the noise.
constexpr double kMaxDeviations = 6.0;
const char* const kStage = "removing the noise";

/// Height of the noise and length of the edges at a vertex.
struct Place {
    double height, edge;
};

Place placeOf(const RemovalOptions& options, Index i) {
    if (!options.place.isAny()) return {options.height, options.meanEdge};
    return {options.place.height[i], options.place.edge[i]};
}

/// The height of the noise removed by moving the vertices from X0 to X, over that of the noise,
/// from the median.
double removedShare(const Points& X0, const Points& X, const RemovalOptions& options) {
    std::vector<double> displacements;
    for (Index i = 0; i < X.rows(); ++i)
        if (options.mayMove[i])
            displacements.push_back((X.row(i) - X0.row(i)).norm() / placeOf(options, i).height);
    return medianDeviation(std::move(displacements));
}

/// Limits displacements: where triangles are narrower than the height of the noise, normals are
/// unreliable.
/// @param deviations  largest displacement in standard deviations of the noise.
void limitDisplacement(const Points& X0, const RemovalOptions& options, double deviations,
                       Points& X) {
    const double edges = options.areImpulses ? 3.0 : 0.3;
    for (Index i = 0; i < X.rows(); ++i) {
        const Place place = placeOf(options, i);
        const double limit = std::max(deviations * place.height, edges * place.edge);
        const Eigen::RowVector3d displacement = X.row(i) - X0.row(i);
        const double length = displacement.norm();
        if (length > limit) X.row(i) = X0.row(i) + limit / length * displacement;
    }
}

/// Unfolds faces, within the limit of all displacements.
void finish(const FaceGraph& graph, const Points& X0, const Points& N,
            const RemovalOptions& options, Points& X) {
    constexpr double kMaxAlongSurface = 5.0;  // heights of the noise
    Eigen::VectorXd limit(X.rows());
    for (Index i = 0; i < X.rows(); ++i) limit[i] = kMaxAlongSurface * placeOf(options, i).height;
    unfoldFaces(graph, N, limit, options.mayMove, X);
    limitDisplacement(X0, options, kMaxDeviations, X);
}

double edgeScale(const RemovalOptions& options, double scale) {
    return options.keepCreases ? scale : std::numeric_limits<double>::infinity();
}

NormalFilterOptions filterOfLength(double length, const RemovalOptions& options) {
    constexpr double kTime = 1.5, kEdgeScale = 0.22, kBlurs = 2.0;
    return {kTime * length * length, edgeScale(options, kEdgeScale), 0.0,
            static_cast<int>(kBlurs * length * length)};
}

int sweepsOfLength(double length) {
    constexpr double kSweeps = 12.0;
    return static_cast<int>(std::lround(kSweeps * length));
}

/// How much weaker the rounds for weak noise are: the divisor of their time.
double weakening(const Place& place) {
    constexpr double kHalfTimeAt = 0.13;  // height in edges
    return 1.0 + std::pow(kHalfTimeAt * place.edge / place.height, 3);
}

/// Factors on the time of every face where noise differs; hardly any where there is none.
Eigen::VectorXd timesOfFaces(const FaceGraph& graph, const RemovalOptions& options) {
    constexpr double kLeast = 1e-6;
    Eigen::VectorXd time(graph.faceCount());
    for (Index f = 0; f < graph.faceCount(); ++f) {
        time[f] = kLeast;
        for (int c = 0; c < 3; ++c)
            if (const int i = graph.F(f, c); options.mayMove[i])
                time[f] = std::max(time[f], 1.0 / weakening(placeOf(options, i)));
    }
    return time;
}

/// What a displacement removes along the normals, in heights of the noise of each place.
Eigen::VectorXd removedAlongNormals(const FaceGraph& graph, const Points& X0, const Points& X,
                                    const RemovalOptions& options) {
    Eigen::VectorXd along = displacementAlongNormals(graph, X0, X);
    if (options.place.isAny())
        along = (options.place.height.array() > 0.0)
                    .select(along.cwiseQuotient(options.place.height), 0.0);
    return along;
}

struct FilteredInRounds {
    Removal removal;
    Points N;  ///< m x 3: the filtered normals of the last round.
};

/// Weak, then stronger rounds of the filter of the normals.
FilteredInRounds filterInRounds(const FaceGraph& graph, const Points& X0,
                                const RemovalOptions& options, const Progress& progress) {
    struct Round {
        double time;
        int sweeps;
        double edgeScale;
    };
    constexpr Round kWeakRound{4.0, 16, 0.25}, kStrongRound{8.0, 32, 0.22};
    constexpr int kWeakRounds = 6, kMaxRounds = 10;
    constexpr double kMaxRemoved = 1.03;  // multiple of the height
    constexpr double kMaxSmoothness = 0.957, kFirstSmoothness = 0.76, kColour = 0.75;

    const bool isByPlace = options.place.isAny();
    const Eigen::VectorXd times = isByPlace ? timesOfFaces(graph, options) : Eigen::VectorXd();
    FilteredInRounds result{{X0, 0}, {}};
    auto& [removal, N] = result;
    double maxSmoothness = 0.0;
    while (removal.rounds < kMaxRounds) {
        progress.report(double(removal.rounds) / kMaxRounds, kStage);
        const Round& round = removal.rounds < kWeakRounds ? kWeakRound : kStrongRound;
        NormalFilterOptions filter;
        filter.time = round.time;
        filter.edgeScale = edgeScale(options, round.edgeScale);
        filter.useTwicing = true;
        if (isByPlace) {
            filter.timeOfFace = &times;
        } else {
            filter.time /= weakening({options.height, options.meanEdge});
            filter.height = options.height / options.meanEdge;
        }
        const Points next = filterNormals(graph, removal.X, filter, N);
        Points X = followNormals(graph, X0, next, options.mayMove, round.sweeps);
        limitDisplacement(X0, options, kMaxDeviations, X);
        const double smooth =
            smoothness(graph.vertices, removedAlongNormals(graph, X0, X, options));
        if (removal.rounds == 0)
            maxSmoothness =
                kMaxSmoothness * std::pow(std::max(1.0, smooth / kFirstSmoothness), kColour);
        else if (smooth > maxSmoothness)
            break;
        N = next;
        removal.X = X;
        ++removal.rounds;
        if (removedShare(X0, X, options) > kMaxRemoved) break;
    }
    return result;
}

/// Linear steps in which neighbours along a scan line weigh more than those across.
Removal removeFromScanLines(const FaceGraph& graph, const Points& X0,
                            const RemovalOptions& options) {
    constexpr int kMaxStepsOnLines = 226;
    FaceGraph weighted = graph;
    weighted.vertices = weightedByLength(graph.vertices, X0, 1.0);
    const LinearStepsByPlace linear =
        linearStepsByPlace(weighted, X0, options.mayMove, options.place, kMaxStepsOnLines);
    Removal removal{linear.X, linear.steps};
    limitDisplacement(X0, options, kMaxDeviations, removal.X);
    return removal;
}

/// Linear steps in the places where they do better, rounds elsewhere.
Removal removeByPlace(const FaceGraph& graph, const Points& X0, const RemovalOptions& options,
                      const Progress& progress) {
    constexpr double kFew = 0.02;  // share of the vertices that rounds are not worthwhile for
    constexpr int kBlursOfResult = 2, kMaxStepsByPlace = 160;
    const LinearStepsByPlace linear =
        linearStepsByPlace(graph, X0, options.mayMove, options.place, kMaxStepsByPlace);
    Removal removal{linear.X, linear.steps};
    if (linear.rejected > kFew) {
        const Removal rounds = filterInRounds(graph, X0, options, progress).removal;
        removal.X = rounds.X + linear.share.asDiagonal() * (linear.X - rounds.X);
        removal.rounds = rounds.rounds;
    }
    Points N = blurredNormals(graph, areaNormals(removal.X, graph.F), kBlursOfResult);
    normalizeRows(N);
    finish(graph, X0, N, options, removal.X);
    return removal;
}

/// Noise of a scanner lies along its rays. That of the pixels of a depth camera is as large as the
/// details; otherwise the strength is doubled until the removed height is that of the noise.
Removal removeAlongRays(const FaceGraph& graph, const Points& X0, const RemovalOptions& options) {
    constexpr double kStrengthOfPixels = 12.0, kWeakest = 1.0, kStrongest = 16.0;
    constexpr double kGrazing = 0.2;  // cosine: such faces do not say where on its ray a vertex is
    constexpr int kSweepsAlong = 160, kIterations = 5, kLong = 128;
    const Points& D = options.rays.direction;
    Removal removal{X0, kIterations};
    for (double strength = options.rays.arePixels ? kStrengthOfPixels : kWeakest;
         strength <= kStrongest; strength *= 2.0) {
        Points N = normalsOfLeastVariation(graph, X0, strength);
        for (Index f = 0; f < N.rows(); ++f)  // such as a bridge over a silhouette
            if (std::abs(N.row(f).dot(D.row(graph.F(f, 0)))) < kGrazing) N.row(f).setZero();
        removal.X = followNormalsAlong(graph, X0, N, D, options.mayMove, kSweepsAlong);
        if (options.rays.arePixels) break;
        Eigen::VectorXd removed = removedAlongNormals(graph, X0, removal.X, options).cwiseAbs();
        if (medianDeviation({removed.begin(), removed.end()}) > options.height) break;
    }
    // Noise has no long waves: those that flatter normals add up to are taken off.
    Eigen::VectorXd along = (removal.X - X0).cwiseProduct(D).rowwise().sum();
    along -= LocalAverage(graph.vertices, options.mayMove, kLong).of(along);
    for (Index i = 0; i < along.size(); ++i)
        if (!options.mayMove[i]) along[i] = 0.0;
    removal.X = X0 + along.asDiagonal() * D;
    return removal;
}

}  // namespace

Removal removeWhiteNoise(const FaceGraph& graph, const Points& X0, const RemovalOptions& options,
                         const Progress& progress) {
    progress.report(0.0, kStage);
    if (options.areScanLines) return removeFromScanLines(graph, X0, options);
    if (options.rays.arePixels) return removeAlongRays(graph, X0, options);
    if (options.place.isAny()) return removeByPlace(graph, X0, options, progress);
    if (options.isUnderShape) {
        Removal removal{withLeastRisk(graph, X0, options.mayMove, options.height), 1};
        limitDisplacement(X0, options, kMaxDeviations, removal.X);
        return removal;
    }
    if (std::optional<LinearSteps> linear = linearSteps(
            graph, X0, options.mayMove, options.height / options.meanEdge, options.areImpulses)) {
        finish(graph, X0, linear->N, options, linear->X);
        return {std::move(linear->X), linear->steps};
    }
    if (options.rays.direction.rows() > 0) return removeAlongRays(graph, X0, options);
    auto [removal, N] = filterInRounds(graph, X0, options, progress);
    finish(graph, X0, N, options, removal.X);
    return std::move(removal);
}

Removal removeCorrelatedNoise(const FaceGraph& graph, const Points& X0,
                              const RemovalOptions& options, const Progress& progress) {
    constexpr double kLengthOfSize = 0.8, kMaxLength = 4.0;
    if (options.rays.direction.rows() > 0) return removeAlongRays(graph, X0, options);
    constexpr double kMinRemoved = 0.8;  // part of the height; the rest is as long as details
    constexpr int kMinRounds = 2, kMaxLongRounds = 6;
    const double length = std::min(kLengthOfSize * options.size, kMaxLength);
    Removal removal{X0, 0};
    Points N;
    double removed = 0.0;  // part of the height
    while (removal.rounds < kMinRounds ||
           (removed < kMinRemoved && removal.rounds < kMaxLongRounds)) {
        progress.report(double(removal.rounds) / kMaxLongRounds, kStage);
        N = filterNormals(graph, removal.X, filterOfLength(length, options), N);
        removal.X = followNormals(graph, X0, N, options.mayMove, sweepsOfLength(length));
        removed = removedShare(X0, removal.X, options);
        limitDisplacement(X0, options, kMaxDeviations, removal.X);
        ++removal.rounds;
    }
    finish(graph, X0, N, options, removal.X);
    return removal;
}

Removal removeVoxelSteps(const FaceGraph& graph, const Points& X0, const Eigen::RowVector3d& voxel,
                         const Eigen::Matrix3d& axes, const RemovalOptions& options,
                         const Progress& progress) {
    constexpr double kLengthOfCentres = 1.5, kLengthOfFaces = 2.0, kThickness = 0.5;
    constexpr int kRounds = 3;
    const double length = options.areVoxelFaces ? kLengthOfFaces : kLengthOfCentres;
    // For thick slices, the filter works in units between lengths and voxels.
    const Eigen::RowVector3d scale =
        (voxel.minCoeff() * voxel.cwiseInverse()).array().pow(kThickness);
    const Eigen::RowVector3d half = 0.5 * voxel.cwiseProduct(scale);
    const Points start = X0 * axes.transpose() * scale.asDiagonal();
    Removal removal{start, 0};
    while (removal.rounds < kRounds) {
        progress.report(double(removal.rounds) / kRounds, kStage);
        const Points N = filterNormals(graph, removal.X, filterOfLength(length, options));
        removal.X = followNormals(graph, start, N, options.mayMove, sweepsOfLength(length));
        for (Index i = 0; i < start.rows(); ++i)
            removal.X.row(i) =
                removal.X.row(i).cwiseMax(start.row(i) - half).cwiseMin(start.row(i) + half);
        ++removal.rounds;
    }
    // Add to X0, so that a vertex that has not moved stays bit-identical.
    removal.X = X0 + (removal.X - start) * scale.cwiseInverse().asDiagonal() * axes;
    return removal;
}

}  // namespace spectral
