#include "core/filter/fractional_filter.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "core/filter/automatic_steps.h"
#include "core/filter/fractional_steps.h"
#include "core/filter/thin_parts.h"
#include "core/laplacian/interior.h"
#include "core/mesh/contacts.h"
#include "core/mesh/displacement_limit.h"
#include "core/mesh/measures.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
#include "core/support/frequency.h"
#include "core/support/threads.h"
#include "core/transfer/transfer_function.h"

namespace spectral {

namespace {

/// Errors granted to the evaluations of automatic steps, as a root mean square over the surface: a
/// share of the least of the tolerance, the feature size and the mean edge. Of the tolerance it is
/// small since single vertices may be several times worse. The tolerance is a length for the eye,
/// whatever the resolution: on fine meshes it exceeds the details that are filtered, and errors of
/// a few thousandths of an edge turn faces by as much as the noise that is left.
constexpr double kShareOfTolerance = 0.05, kShareOfFeatureSize = 1e-3, kShareOfEdge = 2e-3;

/// The same of the tolerance for products. With the default tolerance, .05 % of the diagonal, even
/// single vertices, up to 30 times worse, are within 1e-6 of the diagonal then: tiles, which are
/// evaluated by other polynomials, fit the whole. Finer than kFinest is lost in round-off.
constexpr double kShareByProducts = 5e-5, kFinest = 1e-8;

/// Evaluations have at least this relative accuracy, however large the tolerance.
constexpr double kLoosestAccuracy = 1e-4;

/// Maximum offset that restores lost volume, relative to the displacement. A surface that moves by
/// a distance changes its volume by at most its area times that distance, but the area may have
/// become much smaller.
constexpr double kMaxOffset = 10.0;

/// A low-pass that leaves less than this fraction of the area, or 1 % of the size, leaves nothing.
constexpr double kMinArea = 1e-4;

/// A vertex that keeps less than this fraction of its area is shrinking to a line or a point.
constexpr double kShrunken = 0.1;

/// More steps make no difference, and take hours.
constexpr int kMaxSteps = 1000;

/// Multiple of the cutoff, or of that of the default size if it is larger, beyond which frequencies
/// are those of single vertices of slivers.
constexpr double kBeyond = 24.0;

void checkOptions(const FilterOptions& options) {
    if (options.steps < 0 || options.steps > kMaxSteps)
        throw InvalidOption("steps = " + std::to_string(options.steps) +
                            ": must be between 1 and " + std::to_string(kMaxSteps) +
                            ", e.g. 10, or 0 for automatic steps");
    if (options.steps == 0 && !(std::isfinite(options.tolerance) && options.tolerance > 0.0))
        throw InvalidOption("tolerance = " + textOf(options.tolerance) +
                            ": automatic steps need a length above zero, e.g. 0.05 % of the "
                            "diagonal of the bounding box");
    if (options.passes < 0 || options.passes > kMaxPasses)
        throw InvalidOption("passes = " + std::to_string(options.passes) +
                            ": must be between 1 and " + std::to_string(kMaxPasses) +
                            ", e.g. 2, or 0 for as many as the tolerance needs");
    if (!(options.conformalShare >= 0.0 && options.conformalShare <= 1.0))
        throw InvalidOption("conformal_share = " + textOf(options.conformalShare) +
                            ": must be between 0 (the paper's update) and 1 (conformal)");
    if (!(options.evaluation.accuracy >= 1e-12 && options.evaluation.accuracy < 1.0))
        throw InvalidOption("accuracy must be between 1e-12 and 1");
    if (!(options.creaseAngle >= 0.0 && options.creaseAngle <= 180.0))
        throw InvalidOption("crease_angle = " + textOf(options.creaseAngle) +
                            ": must be between 0 (no creases) and 180 degrees");
    if (!(options.maxDisplacement >= 0.0 && std::isfinite(options.maxDisplacement)))
        throw InvalidOption("max_displacement = " + textOf(options.maxDisplacement) +
                            ": must be a length, or 0 for no bound");
    checkWeights(options.part);
}

/// Vertices on a fixed boundary or a crease.
std::vector<bool> fixedVerticesOf(const Surface& surface, const FilterOptions& options) {
    std::vector<bool> fixed = fixedVerticesOf(surface.F, surface.X.rows(), options.boundary);
    if (options.creaseAngle <= 0.0) return fixed;
    const std::vector<bool> onCrease = creaseVertices(surface.X, surface.F, options.creaseAngle);
    std::transform(fixed.begin(), fixed.end(), onCrease.begin(), fixed.begin(),
                   std::logical_or<>());
    return fixed;
}

/// Fraction of the area at vertices where little of it is left.
/// @param before, after  vertex areas.
double shrunkenPart(const Eigen::VectorXd& before, const Eigen::VectorXd& after) {
    const auto isShrunken = after.array() < kShrunken * before.array();
    return isShrunken.select(before, 0.0).sum() / before.sum();
}

/// The size of a surface that relative errors of evaluations refer to, length units.
double sizeOf(const Surface& surface) {
    return std::sqrt(surface.X.rowwise().squaredNorm().mean());  // X is centred
}

/// Evaluation options; those of automatic steps need not be much more accurate than the steps and
/// the details.
EvaluationOptions evaluationFor(const FilterOptions& options, const Surface& surface,
                                double meanEdge) {
    EvaluationOptions evaluation = options.evaluation;
    if (options.steps > 0) return evaluation;
    const double error =
        std::min({kShareOfTolerance * options.tolerance, kShareOfFeatureSize * options.featureSize,
                  kShareOfEdge * meanEdge});
    evaluation.accuracy =
        std::max(evaluation.accuracy, std::min(error / sizeOf(surface), kLoosestAccuracy));
    const double fine = std::max(kShareByProducts * options.tolerance / sizeOf(surface), kFinest);
    evaluation.finerByProducts = std::min(fine / evaluation.accuracy, 1.0);
    evaluation.atEveryVertex = false;
    return evaluation;
}

/// Which rows of the surface are inner vertices of a tile.
std::optional<ThinPartsOfTile> thinPartsOfTile(const FilterOptions& options,
                                               const Surface& surface) {
    if (!options.whole) return {};
    ThinPartsOfTile tile{{}, options.whole->hasThinParts};
    for (const Index i : surface.vertex) tile.inner.push_back(options.whole->inner[i]);
    return tile;
}

/// Runs the requested steps.
AutomaticSteps filterInSteps(LaplacianBuilder& laplacians, StepEvaluator& evaluate,
                             const TransferFunction& F, const Vertices& X, double meanEdge,
                             const FilterOptions& options, const ThinPartsOfTile* tile,
                             const Progress& progress) {
    // A truncated spectrum may drop the residual even if the gain is 1.
    const bool isIdentity = F.isOne() && options.evaluation.spectrum == Spectrum::Full;
    // A truncated basis is that of the mesh, whose metric must not change.
    const bool areThinPartsKept = options.keepThinParts &&
                                  options.transferFunction.type == FilterType::LowPass &&
                                  options.evaluation.spectrum == Spectrum::Full;
    const bool isAutomatic = options.steps == 0 && options.basisUpdate != BasisUpdate::None;
    AutomaticSteps done;
    if (!isIdentity && !isAutomatic && areThinPartsKept)
        done.thinPartFactor = keepThinParts(laplacians, evaluate, X, tile, progress.part(0.0, 0.0));
    if (isIdentity || options.basisUpdate == BasisUpdate::None) {
        // Powers of one operator commute: K steps are the whole filter. A gain of 1 keeps all bits.
        if (isIdentity) {
            requireUsable(laplacians.current());
            done.last.X = X;
        } else {
            done.last = fixedSteps(laplacians, evaluate, X, 1, progress);
        }
        const int K = std::max(1, options.steps);
        done.last.sizes.assign(static_cast<std::size_t>(K), 1.0 / K);
        return done;
    }
    if (options.steps == 0) {
        if (options.evaluation.spectrum == Spectrum::Full && F.discontinuities().empty()) {
            const double size =
                defaultFeatureSize(meanEdge, std::numeric_limits<double>::infinity());
            const double last = kBeyond * std::max(F.cutoff(), cutoffFrequency(size));
            laplacians.boundEigenvalues(last * last);
        }
        return automaticSteps(
            laplacians, evaluate, X,
            {options.tolerance, options.maxSteps, options.passes, areThinPartsKept, tile},
            progress);
    }
    done.last = fixedSteps(laplacians, evaluate, X, options.steps, progress);
    return done;
}

}  // namespace

FilterResult fractionalFilter(const VerticesView& V, const FacesView& F, const FilterOptions& given,
                              const Progress& caller) {
    const Progress progress = caller.forwards();
    const ThreadTeam team(progress);
    // First: a mesh that is not finite has no valid feature size.
    checkMesh(V, F, given.laplacian);
    FilterOptions options = given;
    if (options.tolerance == 0.0) options.tolerance = defaultTolerance(lengthsOf(V, F));
    checkOptions(options);
    auto [surface, edges] = joinedSurfaceWithEdges(V, F);
    const TransferFunction transfer(options.transferFunction, cutoffFrequency(options.featureSize));
    const std::vector<bool> isFixed = fixedVerticesOf(surface, options);
    keepFixed(isFixed, surface);
    const Interior interior(connectedComponents(surface.F, surface.X.rows()), isFixed);

    std::vector<bool> alongEdges;
    if (options.creaseAngle == 0.0 && !options.whole)
        alongEdges = alongSharpEdges(surface.X, surface.F, edges);
    std::optional<LaplacianBuilder> laplacians(std::in_place, surface, interior.surfaceComponents(),
                                               options.laplacian, options.basisUpdate,
                                               options.conformalShare, std::move(edges));
    const double edge = meanEdgeLength(surface.X, surface.F),
                 meanEdge = options.whole ? options.whole->meanEdge : edge;
    const EvaluationOptions evaluation = evaluationFor(options, surface, meanEdge);
    StepEvaluator evaluate(evaluation, interior, transfer);
    const std::optional<ThinPartsOfTile> tile = thinPartsOfTile(options, surface);
    // Kovnatsky et al. 2012, Eq. 11, or its limit.
    AutomaticSteps steps = filterInSteps(*laplacians, evaluate, transfer, surface.X, meanEdge,
                                         options, tile ? &*tile : nullptr, progress);
    if (!steps.last.X.allFinite()) throw SolverFailure("the filtered coordinates are not finite");
    const double areaBefore = surfaceArea(surface.X, surface.F);
    // A tile may hold nothing but small debris.
    if (!options.whole && options.steps == 0 &&
        options.transferFunction.type == FilterType::LowPass &&
        surfaceArea(steps.last.X, surface.F) < kMinArea * areaBefore)
        throw SolverFailure(ErrorCode::ShrinksToNothing, "the whole surface shrinks to nothing");
    laplacians->reset();
    const Eigen::VectorXd weight =
        vertexWeight(options.part, surface, interior, laplacians->current(), options.featureSize);
    laplacians = std::nullopt;  // a third of all memory
    Vertices displacement = std::move(steps.last.X);
    displacement = weight.asDiagonal() * (displacement - surface.X);
    PreservedVolumes volumes;
    if (options.preserveVolume) {
        Vertices X = surface.X + displacement;
        volumes = preserveVolumes(surface.X, surface.F, interior.surfaceComponents(), weight,
                                  kMaxOffset, X);
        displacement = X - surface.X;
    }
    const Eigen::VectorXd before = lumpedMass(surface.X, surface.F);
    const double limited =
        limitDisplacement(surface.F, before, options.maxDisplacement,
                          ringsWithin(0.5 * options.featureSize / meanEdge), displacement);
    moveContactsAlike(surface, interior.surfaceComponents(), displacement);
    followEdges(surface, displacement);

    FilterResult result;
    static_cast<SurfaceCounts&>(result) =
        countsOf(surface, V.rows(), interior.surfaceComponents().count, interior.fixedVertices());
    static_cast<Movement&>(result) =
        movementOf(surface.X, surface.F, displacement, before, volumes);
    result.limitedShare = limited;
    if (!alongEdges.empty()) result.roundedCreases = roundedCreases(alongEdges, displacement);
    static_cast<Work&>(result) = evaluate.work();
    result.V = moved(V, surface, displacement);
    result.maxDisplacement = std::max(result.maxDisplacement, largestAtSeams(V, result.V, surface));
    result.steps = static_cast<int>(steps.last.sizes.size());
    result.passes = steps.passes;
    result.stepSizes = steps.last.sizes;
    // The evaluations bound a root mean square; on a thousandth of the surface errors are 1.4
    // (boosts) to 6 times (sharp edges) that bound.
    constexpr double kTail = 3.0;
    const double evaluated = kTail * steps.last.errorEstimate * sizeOf(surface);
    if (steps.passes > 0) result.stepError = std::hypot(steps.error, evaluated);
    result.singularPart = steps.singularPart;
    result.thinPartFactor = steps.thinPartFactor;
    result.toleranceReached = steps.passes == 0 || options.passes > 0 ||
                              (std::max(steps.error, evaluated) <= options.tolerance &&
                               steps.singularPart <= kNegligibleArea);
    result.cutoffFrequency = transfer.cutoff();
    result.featureSize = options.featureSize;
    const Vertices X = surface.X + displacement;
    result.shrunkenPart = shrunkenPart(before, lumpedMass(X, surface.F));
    result.areaBefore = areaBefore;
    result.areaAfter = surfaceArea(X, surface.F);
    result.meanEdge = edge;
    result.accuracy = evaluation.accuracy;
    result.errorEstimate = steps.last.errorEstimate;
    result.accuracyReached = steps.last.accuracyReached;

    const HarmonicBasis& basis = evaluate.basis();
    result.eigenvalues = basis.lambda;
    result.residuals = basis.residuals;
    result.inertiaCount = static_cast<int>(basis.inertiaCount);
    result.computedBases = evaluate.computedBases();
    if (evaluation.spectrum == Spectrum::Truncated && basis.size() > 0)
        result.cutoffReached = std::sqrt(basis.lambda[basis.size() - 1]) >= transfer.cutoff();
    return result;
}

}  // namespace spectral
