#include "core/denoise/removal.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/denoise/least_risk.h"
#include "core/denoise/linear_steps.h"
#include "core/denoise/noise_splitting.h"
#include "core/denoise/normal_filter.h"
#include "core/denoise/unfold.h"
#include "core/denoise/vertex_update.h"
#include "core/denoise/whiteness.h"
#include "core/graph/local_average.h"
#include "core/graph/robust_statistics.h"
#include "core/noise/noise_estimate.h"

namespace spectral {

namespace {

const char* const kStage = "removing the noise";

/// The height of the noise removed by moving the vertices from X0 to X, over that of the noise,
/// from the median.
double removedShare(const Points& X0, const Points& X, const RemovalOptions& options) {
    std::vector<double> displacements;
    for (Index i = 0; i < X.rows(); ++i)
        if (options.mayMove[i])
            displacements.push_back((X.row(i) - X0.row(i)).norm() / options.noise.height[i]);
    return medianDeviation(std::move(displacements));
}

/// Largest displacement, in standard deviations of the noise.
constexpr double kMaxDeviations = 6.0;

/// Limits displacements: where triangles are narrower than the height of the noise, normals are
/// unreliable.
void limitDisplacement(const Points& X0, const RemovalOptions& options, Points& X) {
    constexpr double kMaxOfImpulses = 3.0;  // edges
    for (Index i = 0; i < X.rows(); ++i) {
        const double limit = options.areImpulses ? kMaxOfImpulses * options.noise.edge[i]
                                                 : kMaxDeviations * options.noise.height[i];
        const Eigen::RowVector3d displacement = X.row(i) - X0.row(i);
        const double length = displacement.norm();
        if (length > limit) X.row(i) = X0.row(i) + limit / length * displacement;
    }
}

double edgeScale(const RemovalOptions& options, double scale) {
    return options.keepCreases ? scale : std::numeric_limits<double>::infinity();
}

/// How much weaker the rounds for weak noise are, and by how much noise tilts short faces, at every
/// face.
FacesInNoise facesInNoise(const FaceGraph& graph, const RemovalOptions& options) {
    constexpr double kLeast = 1e-6;
    constexpr double kHalfTimeAt = 0.13;  // height in edges
    FacesInNoise faces;
    faces.time.setConstant(graph.faceCount(), kLeast);
    faces.height.setZero(graph.faceCount());
    const NoiseField& noise = options.noise;
    Eigen::VectorXd time(noise.height.size());
    for (Index i = 0; i < time.size(); ++i)
        time[i] = 1.0 / (1.0 + std::pow(kHalfTimeAt * noise.edge[i] / noise.height[i], 3));
    for (Index f = 0; f < graph.faceCount(); ++f)
        for (int c = 0; c < 3; ++c) {
            const int i = graph.F(f, c);
            if (!options.mayMove[i]) continue;
            faces.time[f] = std::max(faces.time[f], time[i]);
            faces.height[f] = std::max(faces.height[f], noise.height[i] / options.meanEdge);
        }
    return faces;
}

/// What a displacement removes along the normals, in heights of the noise of each place.
Eigen::VectorXd removedAlongNormals(const FaceGraph& graph, const Points& X0, const Points& X,
                                    const RemovalOptions& options) {
    const Eigen::VectorXd& height = options.noise.height;
    return (height.array() > 0.0)
        .select(displacementAlongNormals(graph, X0, X).cwiseQuotient(height), 0.0);
}

/// Positions, and the unit normals of the faces that they follow.
struct Followed {
    Removal removal;
    Points N;  ///< m x 3; no rows: they do not say what is folded.
};

constexpr int kWeakRounds = 6, kMaxRounds = 10;

/// Weak, then stronger rounds for white noise.
Followed whiteRounds(const FaceGraph& graph, const Points& X0, const RemovalOptions& options,
                     int maxRounds, const Progress& progress) {
    struct Round {
        double time;
        int sweeps;
        double edgeScale;
    };
    constexpr Round kWeakRound{4.0, 16, 0.25}, kStrongRound{8.0, 32, 0.22};
    constexpr double kMaxRemoved = 1.03;  // multiple of the height
    constexpr double kMaxSmoothness = 0.957, kFirstSmoothness = 0.76, kColour = 0.75;

    const FacesInNoise faces = facesInNoise(graph, options);
    Followed result{{X0, 0}, {}};
    auto& [removal, N] = result;
    double maxSmoothness = 0.0;
    while (removal.rounds < maxRounds) {
        progress.report(double(removal.rounds) / maxRounds, kStage);
        const Round& round = removal.rounds < kWeakRounds ? kWeakRound : kStrongRound;
        NormalFilterOptions filter;
        filter.time = round.time;
        filter.edgeScale = edgeScale(options, round.edgeScale);
        filter.useTwicing = true;
        filter.noise = &faces;
        const Points next = filterNormals(graph, removal.X, filter, N);
        Points X = followNormals(graph, X0, next, options.mayMove, round.sweeps);
        limitDisplacement(X0, options, X);
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

/// The normals of X0 averaged far over the flat parts of what the rounds have made of it, and the
/// positions that follow them.
Followed flattened(const FaceGraph& graph, const Points& X0, Followed rounds,
                   const RemovalOptions& options) {
    constexpr int kSweeps = 60;
    NormalFilterOptions filter;
    filter.time = 6.0;
    filter.edgeScale = 0.22;
    filter.flatness = 30.0;  // with 60, machine parts with weak noise lose
    filter.useTwicing = true;
    filter.accuracy = 0.03;  // flat parts converge slowly, and gain nothing from less
    filter.guide = &rounds.N;
    rounds.N = filterNormals(graph, X0, filter, rounds.N);
    rounds.removal.X = followNormals(graph, X0, rounds.N, options.mayMove, kSweeps);
    limitDisplacement(X0, options, rounds.removal.X);
    ++rounds.removal.rounds;
    return rounds;
}

/// Share of the neighbouring faces whose filtered normals are alike.
double flatShare(const FaceGraph& graph, const Points& N) {
    constexpr double kAlike = 0.02;  // distance of unit normals
    double flat = 0.0, all = 0.0;
    for (Index f = 0; f < graph.faceCount(); ++f)
        for (int c = 0; c < 3; ++c) {
            const int other = graph.neighbours(f, c);
            if (other < 0) continue;
            flat += (N.row(f) - N.row(other)).squaredNorm() < kAlike * kAlike;
            all += 1.0;
        }
    return all > 0.0 ? flat / all : 0.0;
}

/// The rounds and, where that is nearer to the truth by the measured risk, the stage for flat
/// parts.
Followed roundsAndFlatParts(const FaceGraph& graph, const Points& X0, const RemovalOptions& options,
                            const Progress& progress) {
    // Standard deviations. Where the stage helps, the gain is 2.8 and more, on cubes of 1,500
    // vertices 1.3 and more; it is 1.4 on one machine part that loses .2 degrees.
    constexpr double kMinGain = 1.0;
    // At most .05 on round shapes, such as a bumpy torus; at least .45 on machine parts.
    constexpr double kMinFlat = 0.2;
    Followed rounds = whiteRounds(graph, X0, options, kMaxRounds, progress.part(0.0, 0.5));
    // A shape whose details the weak rounds would take next has no flat parts. By place, the risk
    // is too uncertain: a boxy part with noise on half of it would lose .1 degrees.
    if (rounds.removal.rounds <= kWeakRounds || !options.keepCreases || !options.noise.isAlike() ||
        flatShare(graph, rounds.N) < kMinFlat)
        return rounds;
    const SplitNoise split(X0, smoothVertexNormals(graph, rounds.removal.X, 1),
                           options.noise.height);
    RemovalOptions training = options;
    training.noise.height *= SplitNoise::kGrowth;
    const Points& X = split.training();
    const Followed one = whiteRounds(graph, X, training, kWeakRounds, progress.part(0.5, 1.0));
    const Followed other = flattened(graph, X, one, training);
    if (!(split.gain(one.removal.X, other.removal.X) > kMinGain)) return rounds;
    return flattened(graph, X0, std::move(rounds), options);
}

/// Rounds of a filter over `length` edges.
/// @param isDone  (rounds, n x 3 positions, which it may limit) -> whether no more are needed.
template <class IsDone>
Followed longRounds(const FaceGraph& graph, const Points& X0, double length,
                    const RemovalOptions& options, int maxRounds, const Progress& progress,
                    const IsDone& isDone) {
    constexpr double kTime = 1.5, kEdgeScale = 0.22, kBlurs = 2.0, kSweeps = 12.0;
    const NormalFilterOptions filter{kTime * length * length, edgeScale(options, kEdgeScale),
                                     static_cast<int>(kBlurs * length * length)};
    const int sweeps = static_cast<int>(std::lround(kSweeps * length));
    Followed result{{X0, 0}, {}};
    auto& [removal, N] = result;
    for (bool done = false; !done && removal.rounds < maxRounds;) {
        progress.report(double(removal.rounds) / maxRounds, kStage);
        N = filterNormals(graph, removal.X, filter, N);
        removal.X = followNormals(graph, X0, N, options.mayMove, sweeps);
        done = isDone(++removal.rounds, removal.X);
    }
    return result;
}

Followed correlatedRounds(const FaceGraph& graph, const Points& X0, const RemovalOptions& options,
                          const Progress& progress) {
    constexpr double kLengthOfSize = 0.8, kMaxLength = 4.0;
    constexpr double kMinRemoved = 0.8;  // part of the height; the rest is as long as details
    constexpr int kMinRounds = 2, kMaxLongRounds = 6;
    return longRounds(graph, X0, std::min(kLengthOfSize * options.size, kMaxLength), options,
                      kMaxLongRounds, progress, [&](int rounds, Points& X) {
                          const double removed = removedShare(X0, X, options);
                          limitDisplacement(X0, options, X);
                          return rounds >= kMinRounds && removed >= kMinRemoved;
                      });
}

/// Cosine of a face and the ray through it, below which it does not say where on its ray a vertex
/// is.
constexpr double kGrazing = 0.2;

/// Whether each face is a bridge over a silhouette: grazing, and long along its ray.
std::vector<bool> bridges(const FaceGraph& graph, const Points& X, const Points& D) {
    // Medians. A ball before a wall has bridges of 6 to 8; with 4, the noise of a time of flight
    // camera makes 2 % of such faces, with 6 .4 %.
    constexpr double kMinLength = 6.0;
    Points N = areaNormals(X, graph.F);
    normalizeRows(N);
    std::vector<double> length(static_cast<std::size_t>(graph.faceCount()));
    std::vector<bool> isBridge(length.size());
    for (Index f = 0; f < graph.faceCount(); ++f) {
        const Eigen::RowVector3d ray = D(graph.F.row(f), Eigen::all).colwise().mean();
        const Eigen::Vector3d depth = X(graph.F.row(f), Eigen::all) * ray.transpose();
        length[f] = depth.maxCoeff() - depth.minCoeff();
        isBridge[f] = std::abs(N.row(f).dot(ray)) < kGrazing;
    }
    const double least = kMinLength * quantile(length, 0.5);
    for (std::size_t f = 0; f < length.size(); ++f) isBridge[f] = isBridge[f] && length[f] > least;
    return isBridge;
}

/// Noise of a scanner lies along its rays. That of the pixels of a depth camera is as large as the
/// details; otherwise the strength is doubled until the removed height is that of the noise. Faces
/// beside a silhouette do not hear its bridges, and vertices on it stay: they would follow faces on
/// one side.
Removal removeAlongRays(FaceGraph graph, const Points& X0, const RemovalOptions& options) {
    constexpr double kStrengthOfPixels = 12.0, kWeakest = 1.0, kStrongest = 16.0;
    constexpr int kSweepsAlong = 160, kIterations = 5, kLong = 128;
    const Points& D = options.rays.direction;
    const std::vector<bool> isBridge = bridges(graph, X0, D);
    std::vector<bool> mayMove(options.mayMove);
    for (Index f = 0; f < graph.faceCount(); ++f)
        for (int c = 0; c < 3; ++c) {
            int& other = graph.neighbours(f, c);
            if (other >= 0 && isBridge[f] != isBridge[other]) other = -1;
            if (isBridge[f]) mayMove[graph.F(f, c)] = false;
        }
    Removal removal{X0, kIterations};
    for (double strength = options.rays.arePixels ? kStrengthOfPixels : kWeakest;
         strength <= kStrongest; strength *= 2.0) {
        Points N = normalsOfLeastVariation(graph, X0, strength);
        for (Index f = 0; f < N.rows(); ++f)
            if (std::abs(N.row(f).dot(D(graph.F.row(f), Eigen::all).colwise().mean())) < kGrazing)
                N.row(f).setZero();
        removal.X = followNormalsAlong(graph, X0, N, D, mayMove, kSweepsAlong);
        if (options.rays.arePixels) break;
        Eigen::VectorXd removed = removedAlongNormals(graph, X0, removal.X, options).cwiseAbs();
        if (medianDeviation({removed.begin(), removed.end()}) > 1.0) break;
    }
    // Noise has no long waves: those that flatter normals add up to are taken off.
    Eigen::VectorXd along = (removal.X - X0).cwiseProduct(D).rowwise().sum();
    along -= LocalAverage(graph.vertices, mayMove, kLong).of(along);
    for (Index i = 0; i < along.size(); ++i)
        if (!mayMove[i]) along[i] = 0.0;
    removal.X = X0 + along.asDiagonal() * D;
    return removal;
}

/// Linear steps in the places where they do better, rounds elsewhere.
Followed withoutWhiteNoise(const FaceGraph& graph, const Points& X0, const RemovalOptions& options,
                           const Progress& progress) {
    // Neighbours along a scan line weigh more than those across.
    const VertexGraph means =
        options.areScanLines ? weightedByLength(graph.vertices, X0, 1.0) : graph.vertices;
    const bool isAlike = options.noise.isAlike();
    if (options.isUnderShape && isAlike) {
        Removal removal{withLeastRisk(graph, X0, options.mayMove, options.noise.height[0]), 1};
        limitDisplacement(X0, options, removal.X);
        return {std::move(removal), {}};
    }
    if (options.isEven) return roundsAndFlatParts(graph, X0, options, progress);
    LinearSteps linear =
        linearSteps(graph, means, X0, options.mayMove, options.noise, options.areImpulses);
    limitDisplacement(X0, options, linear.X);
    Followed result{{std::move(linear.X), linear.steps}, std::move(linear.N)};
    if (linear.rejected == 0.0 || options.areScanLines) return result;
    if (options.rays.direction.rows() > 0 && isAlike)
        return {removeAlongRays(graph, X0, options), {}};
    Followed rounds = roundsAndFlatParts(graph, X0, options, progress);
    const Points& X = result.removal.X;
    rounds.removal.X += linear.share.asDiagonal() * (X - rounds.removal.X);
    for (Index f = 0; f < graph.faceCount(); ++f) {
        double share = 0.0;
        for (int c = 0; c < 3; ++c) share += linear.share[graph.F(f, c)] / 3.0;
        rounds.N.row(f) += share * (result.N.row(f) - rounds.N.row(f));
    }
    normalizeRows(rounds.N);
    return rounds;
}

}  // namespace

Removal removeNoise(const FaceGraph& graph, const Points& X0, const RemovalOptions& options,
                    const Progress& progress) {
    constexpr double kMaxAlongSurface = 5.0;  // heights of the noise
    progress.report(0.0, kStage);
    if (options.rays.arePixels || (options.rays.direction.rows() > 0 && options.size > 0.0))
        return removeAlongRays(graph, X0, options);
    auto [removal, N] = options.size > 0.0 ? correlatedRounds(graph, X0, options, progress)
                                           : withoutWhiteNoise(graph, X0, options, progress);
    if (N.rows() > 0) {
        unfoldFaces(graph, N, kMaxAlongSurface * options.noise.height, options.mayMove, removal.X);
        limitDisplacement(X0, options, removal.X);
    }
    return std::move(removal);
}

Removal removeVoxelSteps(const FaceGraph& graph, const Points& X0, const Eigen::RowVector3d& voxel,
                         const Eigen::Matrix3d& axes, double length, const RemovalOptions& options,
                         const Progress& progress) {
    constexpr double kThickness = 0.5;
    constexpr int kRounds = 3;
    // For thick slices, the filter works in units between lengths and voxels.
    const Eigen::RowVector3d scale =
        (voxel.minCoeff() * voxel.cwiseInverse()).array().pow(kThickness);
    const Eigen::RowVector3d half = 0.5 * voxel.cwiseProduct(scale);
    const Points start = X0 * axes.transpose() * scale.asDiagonal();
    Removal removal =
        longRounds(graph, start, length, options, kRounds, progress, [&](int, Points& X) {
            for (Index i = 0; i < X.rows(); ++i)
                X.row(i) = X.row(i).cwiseMax(start.row(i) - half).cwiseMin(start.row(i) + half);
            return false;
        }).removal;
    // Add to X0, so that a vertex that has not moved stays bit-identical.
    removal.X = X0 + (removal.X - start) * scale.cwiseInverse().asDiagonal() * axes;
    return removal;
}

}  // namespace spectral
