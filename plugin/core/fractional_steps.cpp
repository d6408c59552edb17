#include "fractional_steps.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "errors.h"

namespace spectral {

namespace {

/// The two second-order results differ by a half to a fifth of the error of either (measured on
/// smooth and on singular flows).
constexpr double kEstimateFactor = 4.0;

/// Part of the allowed error that a new step aims at, so that few are refused.
constexpr double kAim = 0.7;

/// Bounds on the change of the step size from one step to the next.
constexpr double kShrink = 0.25, kGrow = 3.0;

/// A refused step is tried again with at most this part of it.
constexpr double kRetry = 0.7;

constexpr double kFirstStep = 0.125;

/// One tried step of the midpoint rule.
struct Trial {
    Vertices X;
    double error;  // of any vertex, length units
};

Trial midpointStep(const LaplacianBuilder& laplacians, StepEvaluator& evaluate,
                   const Laplacian& start, const Vertices& X, double h, const Progress& progress) {
    evaluate.setLaplacian(start, h, progress.part(0.0, 0.1));
    const Vertices half = evaluate(X, 0.5 * h, progress.part(0.1, 0.3));
    const Vertices whole = evaluate(X, h, progress.part(0.3, 0.5));
    evaluate.setLaplacian(laplacians(half), h, progress.part(0.5, 0.6));
    Trial trial;
    trial.X = evaluate(X, h, progress.part(0.6, 0.8));
    const Vertices twice = evaluate(half, 0.5 * h, progress.part(0.8, 1.0));
    const Vertices extrapolated = 2.0 * twice - whole;
    trial.error = kEstimateFactor * (trial.X - extrapolated).rowwise().norm().maxCoeff();
    return trial;
}

}  // namespace

FractionalSteps fixedSteps(const LaplacianBuilder& laplacians, StepEvaluator& evaluate,
                           const Vertices& X, int K, BasisUpdate update, const Progress& progress) {
    FractionalSteps steps{X, std::vector<double>(static_cast<std::size_t>(K), 1.0 / K)};
    for (int step = 0; step < K; ++step) {
        const std::string name =
            "step " + std::to_string(step + 1) + " of " + std::to_string(K) + ": ";
        const Progress stage = progress.part(static_cast<double>(step) / K, (step + 1.0) / K, name);
        try {
            if (step == 0)
                evaluate.setLaplacian(laplacians.input(), 1.0 / K, stage);
            else if (update != BasisUpdate::None)
                evaluate.setLaplacian(laplacians(steps.X), 1.0 / K, stage);
            steps.X = evaluate(steps.X, 1.0 / K, stage);
            stage.report(1.0, "done");
        } catch (const SolverFailure& failure) {
            throw SolverFailure(
                name + failure.what() +
                (step == 0 || update != BasisUpdate::Full
                     ? ""
                     : ". A strong filter with basis_update = full pinches thin "
                       "parts off: basis_update = conformal is the stabler choice"));
        }
    }
    return steps;
}

FractionalSteps automaticSteps(const LaplacianBuilder& laplacians, StepEvaluator& evaluate,
                               const Vertices& X, const AutomaticOptions& options,
                               const Progress& progress) {
    const double smallest = 1.0 / options.maxSteps;
    FractionalSteps steps{X, {}};
    Laplacian start = laplacians.input();
    double s = 0.0, h = std::max(kFirstStep, smallest);
    while (s < 1.0) {
        // Neither a sliver of a step at the end, nor one that round-off leaves over.
        if (h > 1.0 - s - 0.5 * smallest) h = 1.0 - s;
        const Progress stage =
            progress.part(s, s + h, "step " + std::to_string(steps.sizes.size() + 1) + ": ");
        const bool canShrink = h > smallest * (1.0 + 1e-9);
        std::optional<Trial> trial;
        try {
            trial = midpointStep(laplacians, evaluate, start, steps.X, h, stage);
        } catch (const SolverFailure& failure) {
            if (!canShrink)
                throw SolverFailure(
                    "at " + std::to_string(static_cast<int>(100.0 * s)) +
                    " % of the filter: " + failure.what() +
                    ". Choose basis_update = conformal or laplacian = intrinsic delaunay");
        }

        const double allowed = options.tolerance * h;
        const bool within = trial && trial->error <= allowed;
        if (within || (trial && !canShrink)) {
            s = h == 1.0 - s ? 1.0 : s + h;
            steps.X = std::move(trial->X);
            steps.sizes.push_back(h);
            steps.stepError += trial->error;
            if (!within) steps.singularPart += h;
            if (s < 1.0) start = laplacians(steps.X);
        }
        // The error of a step is of third order, its share of the tolerance of first.
        const double change =
            trial ? kAim * std::sqrt(allowed / std::max(trial->error, 1e-3 * allowed)) : 0.5;
        h = std::max(smallest, h * std::clamp(change, kShrink, within ? kGrow : kRetry));
    }
    return steps;
}

}  // namespace spectral
