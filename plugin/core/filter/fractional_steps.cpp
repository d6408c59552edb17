#include "core/filter/fractional_steps.h"

#include <string>

#include "core/mesh/mesh.h"
#include "core/support/errors.h"

namespace spectral {

namespace {

/// One step of the midpoint rule, or several smaller ones, from `steps` on.
/// @param half  the shape at the half step, where it is known.
void midpointStep(LaplacianBuilder& laplacians, StepEvaluator& evaluate, double h, double smallest,
                  const Vertices* half, const Progress& progress, FractionalSteps& steps) {
    try {
        Vertices predicted;
        if (half == nullptr) {
            evaluate.setLaplacian(laplacians(steps.X), 0.5 * h, progress.part(0.0, 0.1));
            predicted = evaluate.predict(steps.X, {0.5 * h}, progress.part(0.1, 0.5)).front();
            half = &predicted;
        }
        evaluate.setLaplacian(laplacians(*half), h, progress.part(0.5, 0.6));
        steps.X = evaluate(steps.X, h, progress.part(0.6, 1.0));
        steps.sizes.push_back(h);
    } catch (const SolverFailure&) {
        if (0.5 * h < smallest) throw;
        midpointStep(laplacians, evaluate, 0.5 * h, smallest, nullptr, progress.part(0.0, 0.5),
                     steps);
        midpointStep(laplacians, evaluate, 0.5 * h, smallest, nullptr, progress.part(0.5, 1.0),
                     steps);
    }
}

}  // namespace

FractionalSteps fixedSteps(LaplacianBuilder& laplacians, StepEvaluator& evaluate, const Vertices& X,
                           int K, BasisUpdate update, const Progress& progress) {
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

FractionalSteps midpointSteps(LaplacianBuilder& laplacians, StepEvaluator& evaluate,
                              const Vertices& X, int K, int finest, const Progress& progress,
                              const Vertices* firstHalf) {
    const double smallest = (1.0 - 1e-9) / finest;
    FractionalSteps steps{X, {}};
    for (int step = 0; step < K; ++step) {
        const double from = static_cast<double>(step) / K;
        const Progress stage =
            progress.part(from, (step + 1.0) / K,
                          "step " + std::to_string(step + 1) + " of " + std::to_string(K) + ": ");
        try {
            midpointStep(laplacians, evaluate, 1.0 / K, smallest, step == 0 ? firstHalf : nullptr,
                         stage, steps);
        } catch (const SolverFailure& failure) {
            throw SolverFailure("at " + std::to_string(static_cast<int>(100.0 * from)) +
                                " % of the filter: " + failure.what() +
                                ". Choose basis_update = conformal or laplacian = intrinsic "
                                "delaunay");
        }
        stage.report(1.0, "done");
    }
    return steps;
}

}  // namespace spectral
