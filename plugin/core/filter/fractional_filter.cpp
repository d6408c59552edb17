#include "core/filter/fractional_filter.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <string>

#include "core/filter/automatic_steps.h"
#include "core/filter/fractional_steps.h"
#include "core/filter/transfer_function.h"
#include "core/laplacian/frequency.h"
#include "core/laplacian/interior.h"
#include "core/mesh/measures.h"
#include "core/mesh/mesh.h"
#include "core/mesh/mesh_check.h"
#include "core/mesh/surface.h"
#include "core/support/thread_team.h"

namespace spectral {

namespace {

/// Part of the tolerance of automatic steps that their evaluations may take up, in the root mean
/// square over the surface.
constexpr double kEvaluationShare = 0.05;

/// Relative accuracy of evaluations, however large the tolerance is.
constexpr double kCoarsestAccuracy = 1e-4;

void checkOptions(const FilterOptions& options) {
    if (options.steps < 0)
        throw InvalidOption("steps = " + std::to_string(options.steps) +
                            ": give a number of steps, e.g. 10, or 0 for automatic steps");
    if (options.steps == 0 && !(std::isfinite(options.tolerance) && options.tolerance > 0.0))
        throw InvalidOption("tolerance = " + std::to_string(options.tolerance) +
                            ": automatic steps need a length above zero, e.g. 0.05 % of the "
                            "diagonal of the bounding box");
    if (!(options.conformalShare >= 0.0 && options.conformalShare <= 1.0))
        throw InvalidOption("conformal_share = " + std::to_string(options.conformalShare) +
                            ": give a part between 0 (the paper's update) and 1 (conformal)");
    if (!(options.evaluation.accuracy >= 1e-12 && options.evaluation.accuracy < 1.0))
        throw InvalidOption("accuracy must lie between 1e-12 and 1");
}

/// Length of every row of `displacement`, as their maximum and their D-weighted root mean square.
void measureDisplacement(const Vertices& displacement, const Eigen::VectorXd& D,
                         FilterResult& result) {
    const Eigen::VectorXd squares = displacement.rowwise().squaredNorm();
    result.maxDisplacement = std::sqrt(squares.maxCoeff());
    result.rmsDisplacement = std::sqrt(squares.dot(D) / D.sum());
}

std::string nothingMovesWarning() {
    return "nothing can move: every vertex lies on the boundary, which is fixed. Choose boundary = "
           "free; where the triangles of the mesh are not connected, apply 'Merge Close Vertices' "
           "first";
}

std::string accuracyWarning(double requested, double estimate) {
    std::ostringstream text;
    text << std::setprecision(2) << "the requested relative accuracy of " << requested
         << " was not reached, the estimated error is " << estimate
         << ". Choose a stop_gain of 0.05 instead of 0, a lower order or a wider band, or fewer "
            "steps";
    return text.str();
}

std::string toleranceWarning(double tolerance, const AutomaticSteps& steps) {
    std::ostringstream text;
    text << std::setprecision(2) << "the tolerance of " << tolerance << " was not reached on "
         << 100.0 * steps.singularPart << " % of the surface, where the estimated error is "
         << steps.error
         << " and more: parts of it shrink away. Choose a smaller feature_size, or basis_update = "
            "conformal where it is not";
    return text.str();
}

/// @param last  frequency of the basis' last harmonic.
std::string cutoffWarning(const FilterResult& result, double last) {
    std::ostringstream text;
    text << std::setprecision(4) << "the " << result.eigenvalues.size()
         << " harmonics end at features of " << 2.0 * kPi / last << ", above the feature size of "
         << result.featureSize
         << ": details between the two are not told from all finer ones. Choose a larger "
            "feature_size, a larger basis_size, or spectrum = full";
    return text.str();
}

/// The evaluations of automatic steps need not be much finer than the steps.
EvaluationOptions evaluationFor(const FilterOptions& options, const Surface& surface) {
    EvaluationOptions evaluation = options.evaluation;
    if (options.steps > 0) return evaluation;
    const double size = std::sqrt(surface.X.rowwise().squaredNorm().mean());  // X is centred
    evaluation.accuracy =
        std::max(evaluation.accuracy,
                 std::min(kEvaluationShare * options.tolerance / size, kCoarsestAccuracy));
    evaluation.atEveryVertex = false;
    return evaluation;
}

/// The steps that the options ask for.
AutomaticSteps filterInSteps(LaplacianBuilder& laplacians, StepEvaluator& evaluate,
                             const Vertices& X, const FilterOptions& options,
                             const Progress& progress) {
    if (options.steps == 0 && options.basisUpdate != BasisUpdate::None)
        return automaticSteps(laplacians, evaluate, X, {options.tolerance}, progress);
    // Without an update of the basis all powers commute, and one step is the whole filter.
    const int K = options.steps == 0 ? 1 : options.steps;
    FractionalSteps fixed = fixedSteps(laplacians, evaluate, X, K, options.basisUpdate, progress);
    return {std::move(fixed.X), std::move(fixed.sizes)};
}

}  // namespace

FilterResult fractionalFilter(const Vertices& V, const Faces& F, const FilterOptions& options,
                              const Progress& progress) {
    const ThreadTeam team;
    checkMesh(V, F, options.laplacian);  // first: a feature size that is a part of an infinite
    checkOptions(options);               // diagonal is the mesh's fault
    const Surface surface = surfaceOf(V, F);
    const TransferFunction transfer(options.transferFunction, cutoffFrequency(options.featureSize));
    const Interior interior(surface.F, connectedComponents(surface.F, surface.X.rows()),
                            options.boundary);

    LaplacianBuilder laplacians(surface, options.laplacian, options.basisUpdate,
                                options.conformalShare);
    const EvaluationOptions evaluation = evaluationFor(options, surface);
    StepEvaluator evaluate(evaluation, interior, transfer);
    const AutomaticSteps steps = filterInSteps(laplacians, evaluate, surface.X, options, progress);
    const Vertices& X = steps.X;
    if (!X.allFinite()) throw SolverFailure("the filtered coordinates are not finite numbers");

    // The displacement is added to the input: what does not move keeps its coordinates to the bit.
    FilterResult result;
    const Vertices displacement = X - surface.X;
    result.V = V;
    for (Index i = 0; i < X.rows(); ++i) result.V.row(surface.vertex[i]) += displacement.row(i);

    result.steps = static_cast<int>(steps.sizes.size());
    result.stepSizes = steps.sizes;
    result.stepError = steps.error;
    result.singularPart = steps.singularPart;
    result.cutoffFrequency = transfer.cutoff();
    result.featureSize = options.featureSize;
    measureDisplacement(displacement, lumpedMass(surface.X, surface.F), result);
    result.areaBefore = surfaceArea(surface.X, surface.F);
    result.areaAfter = surfaceArea(X, surface.F);
    result.volumeBefore = signedVolume(surface.X, surface.F);
    result.volumeAfter = signedVolume(X, surface.F);
    result.components = interior.surfaceComponents().count;
    result.unreferencedVertices = static_cast<int>(V.rows() - X.rows());
    result.fixedVertices = static_cast<int>(interior.fixedVertices());
    result.factorizations = evaluate.factorizations();
    result.solves = evaluate.solves();
    result.errorEstimate = evaluate.errorEstimate();
    result.accuracyReached = evaluate.accuracyReached();
    result.eigenvalues = evaluate.basis().lambda;
    if (interior.size() == 0) result.warnings.push_back(nothingMovesWarning());
    if (!result.accuracyReached)
        result.warnings.push_back(accuracyWarning(evaluation.accuracy, result.errorEstimate));
    result.toleranceReached = options.steps > 0 || steps.error <= options.tolerance;
    if (!result.toleranceReached)
        result.warnings.push_back(toleranceWarning(options.tolerance, steps));
    if (evaluation.spectrum == Spectrum::Truncated && result.eigenvalues.size() > 0) {
        const double last = std::sqrt(result.eigenvalues[result.eigenvalues.size() - 1]);
        result.cutoffReached = last >= transfer.cutoff();
        if (!result.cutoffReached) result.warnings.push_back(cutoffWarning(result, last));
    }
    result.residuals = evaluate.basis().residuals;
    result.inertiaCount = static_cast<int>(evaluate.basis().inertiaCount);
    result.computedBases = evaluate.computedBases();
    return result;
}

}  // namespace spectral
