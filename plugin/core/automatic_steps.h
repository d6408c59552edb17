#pragma once

#include <vector>

#include "laplacian_builder.h"
#include "progress.h"
#include "step_evaluator.h"
#include "types.h"

namespace spectral {

struct AutomaticOptions {
    double tolerance = 0.0;  ///< Largest error of any vertex, length units, > 0.
    int maxSteps = 64;       ///< Most steps of one pass, >= 4; twice as many where the pass before
                             ///< came near the tolerance.
};

/// The limit of the paper's scheme for infinitely many steps, as far as it was found.
struct AutomaticSteps {
    Vertices X;                 ///< n x 3, the filtered shape.
    std::vector<double> sizes;  ///< The fractional powers of the last pass's steps; sum 1.
    double error = 0.0;         ///< Estimated largest error of any vertex, length units.

    /// Part of the input's surface, 0 to 1, of which the tolerance is not known to hold: 0 when
    /// `error` is within it. Elsewhere it holds.
    double singularPart = 0.0;
};

/// The limit of the paper's scheme for K to infinity, to a tolerance.
///
/// The midpoint rule (midpointSteps) runs with K = 1, 2, 4, ... equal steps. Its error is a series
/// in 1/K that starts with the square, so that Richardson's
///     E_K = Y_K + (Y_K - Y_K/2) / 3
/// takes the first term away, and E_K - E_K/2, with the rate at which such differences have been
/// seen to shrink, estimates the error of E_K: of the final shape, after the filter has damped the
/// errors of the single steps or not. The passes before the last cost as much as the last.
///
/// Where thin parts pinch off, the flow is singular: there no number of steps comes near a limit.
/// The passes end when nothing but such parts, next to no area of the result, is left outside the
/// tolerance and has stopped converging, or at maxSteps; X is then Y_K.
///
/// Equal steps, because smaller ones where the local error is large do not pay: chosen by the
/// largest local error of a vertex they took as many steps for the same error of the result, since
/// a spike in collapse has a large local error and leaves none.
///
/// @throws SolverFailure  as midpointSteps does.
AutomaticSteps automaticSteps(const LaplacianBuilder& laplacians, StepEvaluator& evaluate,
                              const Vertices& X, const AutomaticOptions& options,
                              const Progress& progress);

}  // namespace spectral
