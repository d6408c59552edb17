#include "core/filter/fractional_steps.h"

#include <string>
#include <utility>

#include "core/support/errors.h"

namespace spectral {

namespace {

/// Appends a step of size h.
/// @throws SolverFailure  when the accumulated error is too large; `steps` is then unchanged.
void append(Evaluation step, double h, FractionalSteps& steps) {
    const double error = steps.errorEstimate + step.errorEstimate;
    requireUsefulAccuracy(error);
    steps.errorEstimate = error;
    steps.accuracyReached = steps.accuracyReached && step.accuracyReached;
    steps.before = std::exchange(steps.X, std::move(step.Y.front()));
    steps.sizes.push_back(h);
}

/// Fraction of its area that a surface must keep in a half step: the Laplacian of a collapsed
/// surface says nothing about the step. A high-pass would leave the shape unchanged, for any number
/// of steps.
constexpr double kMinArea = 1e-2;

/// One step of the midpoint rule, or several smaller ones.
/// @param X      shape before the first step, which `steps` does not hold.
/// @param half   shape at the half step if it is known, else empty.
/// @param ahead  shape whose Laplacian predicts the half step; empty: that of the step's start.
void midpointStep(LaplacianBuilder& laplacians, StepEvaluator& evaluate, const Vertices& X,
                  double h, double smallest, Vertices half, Vertices ahead,
                  const Progress& progress, FractionalSteps& steps) {
    const Vertices& start = steps.sizes.empty() ? X : steps.X;
    try {
        double area = laplacians.inputMass().sum();
        if (half.rows() == 0) {
            laplacians.update(ahead.rows() > 0 ? ahead : start);
            ahead.resize(0, 3);
            area = laplacians.area();
            half = evaluate.predict(laplacians.current(), start, {0.5 * h}, progress.part(0.0, 0.5))
                       .Y.front();
        }
        laplacians.update(half);
        half.resize(0, 3);
        if (laplacians.area() < kMinArea * area)
            throw SolverFailure(ErrorCode::ShrinksToNothing,
                                "the whole surface shrinks to nothing in half a step");
        append(evaluate(laplacians.current(), start, h, progress.part(0.5, 1.0)), h, steps);
    } catch (const SolverFailure&) {
        if (0.5 * h < smallest) throw;
        for (const double from : {0.0, 0.5})
            midpointStep(laplacians, evaluate, X, 0.5 * h, smallest, {}, {},
                         progress.part(from, from + 0.5), steps);
    }
}

/// The failure of a step that starts from an already filtered shape.
SolverFailure failureDuring(const SolverFailure& failure, const std::string& where) {
    const bool hasOwnRemedy =
        failure.code() == ErrorCode::TooSteep || failure.code() == ErrorCode::ShrinksToNothing;
    return {hasOwnRemedy ? failure.code() : ErrorCode::ShapeCollapsed, where + failure.what()};
}

std::string nameOf(int step, int K) {
    return "step " + std::to_string(step + 1) + " of " + std::to_string(K) + ": ";
}

}  // namespace

FractionalSteps fixedSteps(LaplacianBuilder& laplacians, StepEvaluator& evaluate, const Vertices& X,
                           int K, const Progress& progress) {
    FractionalSteps steps{X, {}};
    for (int step = 0; step < K; ++step) {
        steps.before.resize(0, 3);
        const Progress stage =
            progress.part(static_cast<double>(step) / K, (step + 1.0) / K, nameOf(step, K));
        try {
            // Kovnatsky et al. 2012, Eq. 11.
            step == 0 ? laplacians.reset() : laplacians.update(steps.X);
            append(evaluate(laplacians.current(), steps.X, 1.0 / K, stage), 1.0 / K, steps);
        } catch (const SolverFailure& failure) {
            if (step > 0) throw failureDuring(failure, nameOf(step, K));
            throw SolverFailure(failure.code(), nameOf(step, K) + failure.what());
        }
        stage.report(1.0, "done");
    }
    return steps;
}

FractionalSteps midpointSteps(LaplacianBuilder& laplacians, StepEvaluator& evaluate,
                              const Vertices& X, int K, int finest, const Progress& progress,
                              Vertices firstHalf, Vertices ahead) {
    const double smallest = (1.0 - 1e-9) / finest;
    FractionalSteps steps;
    const bool isAhead = ahead.rows() > 0;
    for (int step = 0; step < K; ++step) {
        const double from = static_cast<double>(step) / K;
        const bool areEven = steps.sizes.size() == static_cast<std::size_t>(step);
        if (isAhead && step > 0 && areEven)
            ahead = 1.25 * steps.X - 0.25 * (step > 1 ? steps.before : X);
        steps.before.resize(0, 3);
        const Progress stage = progress.part(from, (step + 1.0) / K, nameOf(step, K));
        try {
            midpointStep(laplacians, evaluate, X, 1.0 / K, smallest, std::exchange(firstHalf, {}),
                         std::exchange(ahead, {}), stage, steps);
        } catch (const SolverFailure& failure) {
            throw failureDuring(failure, "at " + std::to_string(static_cast<int>(100.0 * from)) +
                                             " % of the filter: ");
        }
        stage.report(1.0, "done");
    }
    steps.before.resize(0, 3);
    return steps;
}

}  // namespace spectral
