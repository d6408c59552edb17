#include "core/denoise/denoise.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/denoise/face_graph.h"
#include "core/denoise/noise_height.h"
#include "core/denoise/normal_filter.h"
#include "core/denoise/unfold.h"
#include "core/denoise/vertex_update.h"
#include "core/mesh/measures.h"
#include "core/mesh/mesh_check.h"
#include "core/mesh/surface.h"
#include "core/support/errors.h"
#include "core/support/threads.h"

namespace spectral {

namespace {

void checkOptions(const DenoiseOptions& options) {
    if (!(options.strength >= 0.0 && std::isfinite(options.strength)))
        throw InvalidOption("strength = " + textOf(options.strength) +
                            ": must be 0 (nothing) or above, e.g. 1 for the noise as estimated");
    if (!(options.noiseHeight >= 0.0 && std::isfinite(options.noiseHeight)))
        throw InvalidOption("noise_height = " + textOf(options.noiseHeight) +
                            ": must be a length, or 0 to have it estimated");
}

// Chosen on four pairs of noisy and clean meshes: see tests/benchmarks/README.md. Noise is measured
// in mean edges.
constexpr double kNone = 0.02, kMost = 1.0;        // less is no noise, more is filtered no more
constexpr double kTime = 1.5, kHalfTimeAt = 0.13;  // less noise takes weaker rounds
constexpr int kMostRounds = 12, kSweeps = 12;
constexpr double kEdgeScale = 0.22;
/// Share of the noise that the displacement has to reach. More rounds would take the shape for
/// noise (Morozov's discrepancy principle).
constexpr double kEnough = 0.96;
// Where triangles are narrower than the noise is high, normals mean little: no vertex moves farther
// than noise of this many standard deviations, or impulses of this many mean edges, had moved it.
constexpr double kMostDeviations = 3.0, kMostEdges = 0.3;
/// An offset that makes up for lost volume is at most so many times the displacement. Noise lies on
/// both sides of a surface, and takes little volume away with it.
constexpr double kMostOffset = 2.0;
constexpr double kMostAlongSurface = 2.5;  // standard deviations, to turn folded faces back

/// Share of the time that the estimate takes, for the progress.
constexpr double kMeasuring = 0.2;

/// @param noise  standard deviation along the normals, in mean edges.
NormalFilterOptions filterFor(double noise, bool keepCreases) {
    NormalFilterOptions filter;
    filter.time = kTime / (1.0 + std::pow(kHalfTimeAt / noise, 3));
    filter.edgeScale = keepCreases ? kEdgeScale : std::numeric_limits<double>::infinity();
    return filter;
}

/// The height of the noise that had moved the vertices from X to X0, by its median.
double removedHeight(const Vertices& X0, const Vertices& X, const std::vector<bool>& isFixed) {
    std::vector<double> displacements;
    for (Index i = 0; i < X.rows(); ++i)
        if (!isFixed[i]) displacements.push_back((X.row(i) - X0.row(i)).norm());
    return medianDeviation(displacements);
}

/// Draws the vertices of X back to within `farthest` of where they were.
void limitDisplacement(const Vertices& X0, double farthest, Vertices& X) {
    for (Index i = 0; i < X.rows(); ++i) {
        const Eigen::RowVector3d displacement = X.row(i) - X0.row(i);
        const double length = displacement.norm();
        if (length > farthest) X.row(i) = X0.row(i) + farthest / length * displacement;
    }
}

}  // namespace

DenoiseResult denoise(const Vertices& V, const Faces& F, const DenoiseOptions& options,
                      const Progress& progress) {
    const ThreadTeam team;
    checkMesh(V, F);
    checkOptions(options);
    const Surface surface = surfaceOf(V, F);
    progress.report(0.0, "measuring the noise");
    const FaceGraph graph = faceGraph(surface.F, surface.X.rows());
    const NoiseEstimate noise = estimateNoise(graph, surface.X);

    DenoiseResult result;
    result.estimatedHeight = noise.height;
    result.noiseHeight =
        options.strength * (options.noiseHeight > 0.0 ? options.noiseHeight : noise.height);
    result.meanEdge = noise.meanEdge;
    const double height = std::min(result.noiseHeight, kMost * noise.meanEdge);
    const bool isNoisy = height > 0.0 && height >= kNone * noise.meanEdge;
    const double farthest = std::max(kMostDeviations * height, kMostEdges * noise.meanEdge);

    std::vector<bool> isFixed(graph.onRim.size(), false);
    if (options.boundary == Boundary::Fixed) isFixed = graph.onRim;
    Vertices X = surface.X;
    if (isNoisy) {
        const NormalFilterOptions filter = filterFor(height / noise.meanEdge, options.keepCreases);
        Normals N;
        double removed = 0.0;  // share of the noise
        while (removed < kEnough && result.rounds < kMostRounds) {
            const double done = std::max(removed, double(result.rounds) / kMostRounds);
            progress.report(kMeasuring + (1.0 - kMeasuring) * done, "removing the noise");
            // From the input: it is the normals that are filtered, the vertices only show them.
            N = filterNormals(graph, X, filter);
            X = followNormals(graph, surface.X, N, isFixed, kSweeps);
            limitDisplacement(surface.X, farthest, X);
            removed = removedHeight(surface.X, X, isFixed) / height;
            ++result.rounds;
        }
        unfoldFaces(graph, N, kMostAlongSurface * result.noiseHeight, isFixed, X);
        limitDisplacement(surface.X, farthest, X);
    }

    const Components components = connectedComponents(surface.F, X.rows());
    Eigen::VectorXd mayMove(X.rows());
    for (Index i = 0; i < X.rows(); ++i) mayMove[i] = isFixed[i] ? 0.0 : 1.0;
    if (isNoisy)
        result.volumes = preserveVolumes(surface.X, graph.F, components, mayMove, kMostOffset, X);
    if (!X.allFinite()) throw SolverFailure("the denoised coordinates are not finite numbers");

    const Vertices displacement = X - surface.X;
    result.V = V;
    for (Index i = 0; i < X.rows(); ++i)
        if ((displacement.row(i).array() != 0.0).any())
            result.V.row(surface.vertex[i]) += displacement.row(i);
    result.maxDisplacement = displacement.rowwise().norm().maxCoeff();
    result.rmsDisplacement = displacement.stableNorm() / std::sqrt(static_cast<double>(X.rows()));
    result.volumeBefore = signedVolume(surface.X, surface.F);
    result.volumeAfter = signedVolume(X, surface.F);
    result.components = components.count;
    result.unreferencedVertices = static_cast<int>(V.rows() - X.rows());
    result.fixedVertices = static_cast<int>(std::count(isFixed.begin(), isFixed.end(), true));
    return result;
}

}  // namespace spectral
