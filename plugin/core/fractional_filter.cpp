#include "fractional_filter.h"

#include <cmath>
#include <iomanip>
#include <sstream>
#include <string>

#include "measures.h"
#include "mesh_check.h"
#include "surface.h"

namespace spectral {

namespace {

void checkOptions(const FilterOptions& options) {
    if (options.steps < 1)
        throw InvalidOption("steps = " + std::to_string(options.steps) +
                            ": the filter is applied in at least 1 step; 10 is a good number");
    if (!std::isfinite(options.featureSize) || options.featureSize <= 0.0)
        throw InvalidOption("feature_size = " + std::to_string(options.featureSize) +
                            ": a feature size is a length above zero, e.g. 5 % of the diagonal of "
                            "the bounding box");
    if (!(options.evaluation.accuracy >= 1e-12 && options.evaluation.accuracy < 1.0))
        throw InvalidOption("accuracy must lie between 1e-12 and 1");
}

/// Eq. 11: X_0 = X, X_(i+1) = F^(1/K)(sqrt(A(X_i))) X_i.
Vertices paperSteps(const LaplacianBuilder& laplacians, StepEvaluator& evaluate,
                    const FilterOptions& options, Vertices X, const Progress& progress) {
    const int K = options.steps;
    for (int step = 0; step < K; ++step) {
        const std::string name =
            "step " + std::to_string(step + 1) + " of " + std::to_string(K) + ": ";
        const Progress stage = progress.part(static_cast<double>(step) / K, (step + 1.0) / K, name);
        try {
            if (step == 0)
                evaluate.setLaplacian(laplacians.input(), 1.0 / K, stage);
            else if (options.basisUpdate != BasisUpdate::None)
                evaluate.setLaplacian(laplacians(X), 1.0 / K, stage);
            X = evaluate(X, 1.0 / K, stage);
            stage.report(1.0, "done");
        } catch (const SolverFailure& failure) {
            throw SolverFailure(
                name + failure.what() +
                (step == 0 || options.basisUpdate != BasisUpdate::Full
                     ? ""
                     : ". A strong filter with basis_update = full pinches thin "
                       "parts off: basis_update = conformal is the stabler choice"));
        }
    }
    return X;
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

}  // namespace

FilterResult fractionalFilter(const Vertices& V, const Faces& F, const FilterOptions& options,
                              const Progress& progress) {
    checkMesh(V, F, options.laplacian);  // first: a feature size that is a part of an infinite
    checkOptions(options);               // diagonal is the mesh's fault
    const Surface surface = surfaceOf(V, F);
    const TransferFunction transfer(options.transferFunction, 2.0 * kPi / options.featureSize);
    const Components components = connectedComponents(surface.F, surface.X.rows());

    const LaplacianBuilder laplacians(surface, options.laplacian, options.basisUpdate);
    StepEvaluator evaluate(options.evaluation, components, transfer);
    const Vertices X = paperSteps(laplacians, evaluate, options, surface.X, progress);
    if (!X.allFinite()) throw SolverFailure("the filtered coordinates are not finite numbers");

    // The displacement is added to the input: what does not move keeps its coordinates to the bit.
    FilterResult result;
    const Vertices displacement = X - surface.X;
    result.V = V;
    for (Index i = 0; i < X.rows(); ++i) result.V.row(surface.vertex[i]) += displacement.row(i);

    result.steps = options.steps;
    result.stepSizes.assign(static_cast<std::size_t>(options.steps), 1.0 / options.steps);
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
    result.eigenvalues = evaluate.basis().lambda;
    return result;
}

}  // namespace spectral
