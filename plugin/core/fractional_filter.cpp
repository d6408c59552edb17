#include "fractional_filter.h"

#include <cmath>
#include <iomanip>
#include <sstream>
#include <string>

#include "fractional_steps.h"
#include "measures.h"
#include "mesh_check.h"
#include "surface.h"

namespace spectral {

namespace {

void checkOptions(const FilterOptions& options) {
    if (options.steps < 0)
        throw InvalidOption("steps = " + std::to_string(options.steps) +
                            ": give a number of steps, e.g. 10, or 0 for automatic steps");
    if (options.steps == 0 && !(std::isfinite(options.tolerance) && options.tolerance > 0.0))
        throw InvalidOption("tolerance = " + std::to_string(options.tolerance) +
                            ": automatic steps need a length above zero, e.g. 0.05 % of the "
                            "diagonal of the bounding box");
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

std::string accuracyWarning(double requested, double estimate) {
    std::ostringstream text;
    text << std::setprecision(2) << "the requested relative accuracy of " << requested
         << " was not reached, the estimated error is " << estimate
         << ". Choose a stop_gain of 0.05 instead of 0, a lower order or a wider band, or fewer "
            "steps";
    return text.str();
}

std::string singularityWarning(double tolerance, const FractionalSteps& steps) {
    std::ostringstream text;
    text << std::setprecision(2) << "during " << 100.0 * steps.singularPart
         << " % of the filter no step was small enough for the tolerance of " << tolerance
         << ", the estimated error is " << steps.stepError
         << ": thin parts pinch off there, the result depends on the steps. basis_update = "
            "conformal shrinks them smoothly";
    return text.str();
}

/// Without an update of the basis all powers commute, and one step is the whole filter.
FractionalSteps filterInSteps(const LaplacianBuilder& laplacians, StepEvaluator& evaluate,
                              const Vertices& X, const FilterOptions& options,
                              const Progress& progress) {
    if (options.steps > 0)
        return fixedSteps(laplacians, evaluate, X, options.steps, options.basisUpdate, progress);
    if (options.basisUpdate == BasisUpdate::None)
        return fixedSteps(laplacians, evaluate, X, 1, BasisUpdate::None, progress);
    return automaticSteps(laplacians, evaluate, X, {options.tolerance}, progress);
}

}  // namespace

FilterResult fractionalFilter(const Vertices& V, const Faces& F, const FilterOptions& options,
                              const Progress& progress) {
    checkMesh(V, F, options.laplacian);  // first: a feature size that is a part of an infinite
    checkOptions(options);               // diagonal is the mesh's fault
    const Surface surface = surfaceOf(V, F);
    const TransferFunction transfer(options.transferFunction, cutoffFrequency(options.featureSize));
    const Components components = connectedComponents(surface.F, surface.X.rows());

    const LaplacianBuilder laplacians(surface, options.laplacian, options.basisUpdate);
    StepEvaluator evaluate(options.evaluation, components, transfer);
    const FractionalSteps steps = filterInSteps(laplacians, evaluate, surface.X, options, progress);
    const Vertices& X = steps.X;
    if (!X.allFinite()) throw SolverFailure("the filtered coordinates are not finite numbers");

    // The displacement is added to the input: what does not move keeps its coordinates to the bit.
    FilterResult result;
    const Vertices displacement = X - surface.X;
    result.V = V;
    for (Index i = 0; i < X.rows(); ++i) result.V.row(surface.vertex[i]) += displacement.row(i);

    result.steps = static_cast<int>(steps.sizes.size());
    result.stepSizes = steps.sizes;
    result.stepError = steps.stepError;
    result.singularPart = steps.singularPart;
    result.cutoffFrequency = transfer.cutoff();
    result.featureSize = options.featureSize;
    measureDisplacement(displacement, lumpedMass(surface.X, surface.F), result);
    result.areaBefore = surfaceArea(surface.X, surface.F);
    result.areaAfter = surfaceArea(X, surface.F);
    result.volumeBefore = signedVolume(surface.X, surface.F);
    result.volumeAfter = signedVolume(X, surface.F);
    result.components = components.count;
    result.unreferencedVertices = static_cast<int>(V.rows() - X.rows());
    result.factorizations = evaluate.factorizations();
    result.solves = evaluate.solves();
    result.errorEstimate = evaluate.errorEstimate();
    result.accuracyReached = evaluate.accuracyReached();
    if (!result.accuracyReached)
        result.warnings.push_back(
            accuracyWarning(options.evaluation.accuracy, result.errorEstimate));
    if (steps.singularPart > 0.0)
        result.warnings.push_back(singularityWarning(options.tolerance, steps));
    result.eigenvalues = evaluate.basis().lambda;
    return result;
}

}  // namespace spectral
