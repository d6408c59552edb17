#include "core/denoise/denoise.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/denoise/crumpling.h"
#include "core/denoise/removal.h"
#include "core/laplacian/laplacian.h"
#include "core/laplacian/vertex_weight.h"
#include "core/mesh/contacts.h"
#include "core/mesh/displacement_limit.h"
#include "core/mesh/measures.h"
#include "core/mesh/mesh_check.h"
#include "core/mesh/surface.h"
#include "core/noise/scan_rays.h"
#include "core/support/errors.h"
#include "core/support/memory.h"
#include "core/support/threads.h"

namespace spectral {

namespace {

void checkOptions(const DenoiseOptions& options) {
    if (!(options.strength >= 0.0 && std::isfinite(options.strength)))
        throw InvalidOption("strength = " + textOf(options.strength) +
                            ": must be 0 (no change) or above, e.g. 1 for the measured noise");
    const auto checkLength = [](const char* name, double length) {
        if (!(length >= 0.0 && std::isfinite(length)))
            throw InvalidOption(std::string(name) + " = " + textOf(length) +
                                ": must be a length, or 0 to measure it");
    };
    checkLength("noise_height", options.noiseHeight);
    checkLength("noise_size", options.noiseSize);
    if (!(options.maxDisplacement >= 0.0 && std::isfinite(options.maxDisplacement)))
        throw InvalidOption("max_displacement = " + textOf(options.maxDisplacement) +
                            ": must be a length, or 0 for no bound");
    if (options.weight.size() == 0) return;
    checkWeights({{}, options.weight});
    if (options.noiseHeight == 0.0)
        throw InvalidOption(
            "weight = vertex quality is a factor on the noise height, which is not given: give "
            "noise_height, such as 0.2e, or choose weight = none");
    if (!(options.weight.maxCoeff() > 0.0))
        throw InvalidOption("weight = vertex quality: it is 0 everywhere; give a noisy vertex 1");
}

/// Edges within which the displacement fades out around a selection, and where it is limited.
constexpr double kFadingOut = 4.0;

/// Fraction of its displacement that each vertex of the surface moves by, 0 to 1.
Eigen::VectorXd displacementWeight(const DenoiseOptions& options, const Surface& surface,
                                   const Interior& interior) {
    const WeightOptions part{options.selected, {}};
    checkWeights(part);
    Laplacian inEdges;  // measures distances in edges, as if all had length 1
    if (!part.selected.empty()) {
        inEdges.W = uniformStiffness(surface.X.rows(), surface.F);
        inEdges.D.setConstant(surface.X.rows(), 0.5 * std::sqrt(3.0));
    }
    return vertexWeight(part, surface, interior, inEdges, kFadingOut);
}

/// Height of the noise at each vertex of the surface, if it is given; else no rows.
Eigen::VectorXd givenHeights(const DenoiseOptions& options, const Surface& surface) {
    if (options.weight.size() == 0) return {};
    return options.noiseHeight * restricted(options.weight, surface);
}

/// The triangles of a surface at which a vertex moves, and their vertices.
struct MovingPart {
    Surface surface;         ///< Its `vertex` holds rows of the whole surface.
    Eigen::VectorXd weight;  ///< Fraction of its displacement that each vertex moves by, 0 to 1.
    Eigen::VectorXd height;  ///< Given height of the noise at each vertex; empty: not given.
    Eigen::RowVector3d eye;  ///< The origin of the file's coordinates, where a camera may be.

    MovingPart(const Surface& whole, const Eigen::VectorXd& weightOfWhole) {
        Faces F(whole.F.rows(), 3);
        Index count = 0;
        for (Index t = 0; t < F.rows(); ++t)
            if ((weightOfWhole(whole.F.row(t).transpose()).array() > 0.0).any())
                F.row(count++) = whole.F.row(t);
        F.conservativeResize(count, 3);
        surface = surfaceOf(whole.X, F);
        weight = weightOfWhole(surface.vertex);
    }
};

/// Correlation length, in mean edges, up to which noise is filtered as white noise.
constexpr double kMaxWhiteSize = 1.25;

/// Height of the noise to remove: as given by the options, or else as measured.
double heightToRemove(const DenoiseOptions& options, const Diagnosis& diagnosis) {
    const double height = options.noiseHeight > 0.0 ? options.noiseHeight : diagnosis.noise.height;
    return std::max(options.strength, 1.0) * height;
}

/// The noise to remove.
RemovalOptions removalOptions(const DenoiseOptions& options, const Diagnosis& diagnosis, Index n) {
    const NoiseEstimate& noise = diagnosis.noise;
    RemovalOptions removal;
    removal.meanEdge = options.meanEdge > 0.0 ? options.meanEdge : noise.meanEdge;
    if (diagnosis.field.isAny()) {
        removal.noise = diagnosis.field;
        removal.noise.height *= std::max(options.strength, 1.0);
    } else {
        removal.noise =
            NoiseField::ofHeight(heightToRemove(options, diagnosis), removal.meanEdge, n);
    }
    removal.noise.height = removal.noise.height.cwiseMin(removal.noise.edge);  // higher is clamped
    // Only the finest octaves of correlated noise can be told from the shape: its true length is
    // about twice the measured one.
    constexpr double kHiddenSize = 2.0;
    removal.size = options.noiseSize > 0.0 ? options.noiseSize / removal.meanEdge
                   : noise.size > 1.0      ? kHiddenSize * noise.size
                                           : 0.0;
    if (removal.size <= kMaxWhiteSize) removal.size = 0.0;
    removal.keepCreases = options.keepCreases;
    removal.isUnderShape = noise.isUnderShape;
    removal.isEven = noise.isEven;
    removal.areScanLines = diagnosis.kind == NoiseKind::ScanLines;
    return removal;
}

Removal removeAsDiagnosed(const FaceGraph& graph, const Points& X, const Diagnosis& diagnosis,
                          bool hasHeight, const RemovalOptions& removal, const Progress& progress) {
    if (diagnosis.kind == NoiseKind::Voxels)
        return removeVoxelSteps(graph, X, diagnosis.voxel, diagnosis.voxelAxes,
                                diagnosis.stepLength, removal, progress);
    if (!hasHeight) return {diagnosis.X, 0};
    return removeNoise(graph, diagnosis.X, removal, progress);
}

/// Memory for the graph of the faces, the measurement and the filter of the normals, bytes per
/// vertex.
constexpr double kBytesPerVertex = 1000.0;

/// Fraction of the progress for the measurement.
constexpr double kMeasuring = 0.3;

/// Measures and removes the noise, and records both in `result`; strength 0 only measures.
/// @return  displacement of the part, n x 3.
Points denoisePart(const MovingPart& part, const FaceGraph& graph, const DenoiseOptions& options,
                   const Progress& progress, DenoiseResult& result) {
    const Points X0 = part.surface.X;
    std::vector<bool> isMeasured(graph.onRim), mayMove(graph.onRim);
    for (Index i = 0; i < X0.rows(); ++i) {
        isMeasured[i] = !graph.onRim[i] && part.weight[i] == 1.0;
        mayMove[i] = part.weight[i] > 0.0;
    }
    const bool isKnown = options.noiseHeight > 0.0;
    Diagnosis& diagnosis = result.diagnosis;
    diagnosis = diagnose(graph, X0, isMeasured, isKnown, progress.part(0.0, kMeasuring));
    const bool areImpulses = diagnosis.kind == NoiseKind::Impulses;
    if (part.height.size() > 0) {
        const bool isOne = part.height.minCoeff() == part.height.maxCoeff();
        diagnosis.field =
            isOne ? NoiseField::ofHeight(part.height[0], diagnosis.noise.meanEdge, X0.rows())
                  : NoiseField::ofHeights(graph, X0, part.height);
        if (!areImpulses) diagnosis.kind = NoiseKind::Local;
    }
    RemovalOptions removal = removalOptions(options, diagnosis, X0.rows());
    removal.areImpulses = areImpulses;
    removal.mayMove = std::move(mayMove);
    for (Index i = 0; i < diagnosis.field.height.size(); ++i)
        removal.mayMove[i] = removal.mayMove[i] && diagnosis.field.height[i] > 0.0;
    if (diagnosis.isNoise() && diagnosis.kind != NoiseKind::Voxels && !isKnown &&
        options.keepCreases)
        removal.rays =
            scanRays(part.eye, graph, X0, isMeasured, diagnosis.kind == NoiseKind::Correlated);
    // Depths of pixels have few values, so that flat parts are noisy, too.
    for (std::size_t i = 0; i < diagnosis.isClean.size() && !removal.rays.arePixels; ++i)
        removal.mayMove[i] = removal.mayMove[i] && !diagnosis.isClean[i];
    const double strength = std::min(options.strength, 1.0);
    const bool hasHeight = diagnosis.kind != NoiseKind::Voxels &&
                           (isKnown || diagnosis.isNoise()) &&
                           removal.noise.height.maxCoeff() > 0.0;
    const auto recordNoise = [&](double share) {
        result.noiseHeight = share * std::min(heightToRemove(options, diagnosis), removal.meanEdge);
        result.noiseSize = removal.size * removal.meanEdge;
    };
    if (strength == 0.0) {
        if (hasHeight) recordNoise(1.0);
        return Points::Zero(X0.rows(), 3);
    }
    Removal done =
        removeAsDiagnosed(graph, X0, diagnosis, hasHeight, removal, progress.part(kMeasuring, 1.0));
    // Along rays nothing can fold: the camera sees the same triangles.
    if (done.rounds > 0 && diagnosis.kind != NoiseKind::Voxels &&
        removal.rays.direction.rows() == 0 && isCrumpled(graph, X0, done.X)) {
        result.isCrumpled = true;
        done = {diagnosis.X, 0};
    }
    result.rounds = done.rounds;
    if (done.rounds > 0 && hasHeight) recordNoise(strength);
    return strength * part.weight.asDiagonal() * (done.X - X0);
}

/// Height of the noise at every vertex of the part, as given or else as measured; 0: none.
Eigen::VectorXd heightsOf(const Diagnosis& diagnosis, const DenoiseOptions& options, Index n) {
    const bool isKnown = options.noiseHeight > 0.0;
    Eigen::VectorXd heights = diagnosis.field.height;
    if (!diagnosis.field.isAny())
        heights.setConstant(n, isKnown ? options.noiseHeight : diagnosis.rmsHeight());
    for (std::size_t i = 0; i < diagnosis.isClean.size(); ++i)
        if (diagnosis.isClean[i]) heights[static_cast<Index>(i)] = 0.0;
    return heights;
}

/// The weights of the offset that restores the volume: clean places stay.
Eigen::VectorXd offsetWeight(Eigen::VectorXd weight, const MovingPart& part,
                             const Diagnosis& diagnosis) {
    const NoiseField& field = diagnosis.field;
    for (std::size_t i = 0; i < diagnosis.isClean.size(); ++i)
        if (diagnosis.isClean[i]) weight[part.surface.vertex[static_cast<Index>(i)]] = 0.0;
    if (field.isAlike()) return weight;  // to the bit as without a field
    for (Index i = 0; i < field.height.size(); ++i)
        weight[part.surface.vertex[i]] *=
            std::min(1.0, field.height[i] / (field.median * field.edge[i]));
    return weight;
}

/// Clamps coordinates along the axes that the volume correction has moved farther than `limit` from
/// X0.
void keepWithin(const Eigen::RowVector3d& limit, const Eigen::Matrix3d& axes, const Vertices& X0,
                Vertices& X) {
    for (Index i = 0; i < X.rows(); ++i) {
        const Eigen::RowVector3d moved = (X.row(i) - X0.row(i)) * axes.transpose();
        if ((moved.cwiseAbs().array() > limit.array()).any())
            X.row(i) = X0.row(i) + moved.cwiseMax(-limit).cwiseMin(limit) * axes;
    }
}

/// Largest offset that restores volume, as a multiple of the displacement: noise lies on both sides
/// of a surface, so removing it changes the volume little.
constexpr double kMaxOffset = 2.0;

}  // namespace

DenoiseResult denoise(const Vertices& V, const Faces& F, const DenoiseOptions& options,
                      const Progress& progress) {
    const ThreadTeam team(progress);
    checkMesh(V, F);
    checkOptions(options);
    progress.report(0.0, "measuring the noise");
    Surface whole = joinedSurface(V, F);
    whole.F = distinctFaces(whole.F, whole.X.rows());
    const std::vector<bool> isFixed = fixedVerticesOf(whole.F, whole.X.rows(), options.boundary);
    keepFixed(isFixed, whole);
    const Interior interior(connectedComponents(whole.F, whole.X.rows()), isFixed);
    const Components& components = interior.surfaceComponents();
    const Eigen::VectorXd weight = displacementWeight(options, whole, interior);
    const Eigen::VectorXd height = givenHeights(options, whole);

    DenoiseResult result;
    result.heights.setZero(V.rows());
    result.diagnosis.noise.meanEdge = meanEdgeLength(whole.X, whole.F);
    static_cast<SurfaceCounts&>(result) =
        countsOf(whole, V.rows(), components.count, interior.fixedVertices());

    Vertices moved = whole.X;
    PreservedVolumes volumes;
    MovingPart part(whole, weight);
    // The surface is centred: the eye is where the origin of the mesh has gone.
    if (part.surface.X.rows() > 0)
        part.eye = part.surface.X.row(0) - V.row(whole.vertex[part.surface.vertex[0]]);
    if (height.size() > 0) part.height = height(part.surface.vertex);
    if (part.surface.X.rows() > 0) {
        const Index n = part.surface.X.rows();
        requireMemory(kBytesPerVertex * static_cast<double>(n), n);
        const FaceGraph graph = faceGraph(part.surface.F, part.surface.X.rows());
        const Points displacement = denoisePart(part, graph, options, progress, result);
        result.heights = extended(extendedByZero(heightsOf(result.diagnosis, options, n),
                                                 part.surface.vertex, whole.X.rows()),
                                  whole, V.rows());
        for (Index i = 0; i < displacement.rows(); ++i)
            moved.row(part.surface.vertex[i]) += displacement.row(i);
        // Prefer the oriented faces of the graph; their indices are valid only if the part is all.
        const bool isWhole = part.surface.F.rows() == whole.F.rows();
        if (result.rounds > 0)
            volumes =
                preserveVolumes(whole.X, isWhole ? graph.F : whole.F, components,
                                offsetWeight(weight, part, result.diagnosis), kMaxOffset, moved);
        if (result.diagnosis.kind == NoiseKind::Voxels)
            keepWithin(0.5 * result.diagnosis.voxel, result.diagnosis.voxelAxes, whole.X, moved);
    }
    Vertices displacement = moved - whole.X;
    if (!displacement.allFinite()) throw SolverFailure("the denoised coordinates are not finite");
    const double limited =
        limitDisplacement(whole.F, lumpedMass(whole.X, whole.F), options.maxDisplacement,
                          ringsWithin(kFadingOut), displacement);
    moveContactsAlike(whole, components, displacement);
    followEdges(whole, displacement);
    result.V = spectral::moved(V, whole, displacement);
    static_cast<Movement&>(result) = movementOf(
        whole.X, whole.F, displacement, Eigen::VectorXd::Ones(displacement.rows()), volumes);
    result.limitedShare = limited;
    result.maxDisplacement = std::max(result.maxDisplacement, largestAtSeams(V, result.V, whole));
    return result;
}

}  // namespace spectral
