#pragma once

#include "core/filter/fractional_steps.h"
#include "core/filter/step_evaluator.h"
#include "core/laplacian/laplacian_builder.h"
#include "core/mesh/mesh.h"
#include "core/support/progress.h"
#include "core/support/types.h"

namespace spectral {

/// Part of a surface that errors of automatic steps leave out: where the flow is nearly singular,
/// often at single vertices.
inline constexpr double kNegligibleArea = 1e-3;

struct AutomaticOptions {
    double tolerance = 0.0;  ///< Largest error over the filtered surface but kNegligibleArea,
                             ///< length units, > 0.
    int maxSteps = 64;       ///< Most steps of one pass, >= 2.
};

/// The limit of the paper's scheme for infinitely many steps, as far as it was found.
struct AutomaticSteps {
    FractionalSteps last;  ///< The last pass; its X may be extrapolated from the last two.
    double error = 0.0;    ///< Estimated error over all but kNegligibleArea of the filtered
                           ///< surface, length units.

    /// Part of the input's surface, 0 to 1, on which the estimated error is above the tolerance.
    double singularPart = 0.0;
};

/// The limit of the paper's scheme for K to infinity, to a tolerance.
///
/// The midpoint rule (midpointSteps) runs in passes of K = 1, 2, 4, ... equal steps. Its error is a
/// series in 1/K that starts with the square, so Richardson's extrapolation
///     E_K = Y_K + (Y_K - Y_K/2) / 3
/// removes the first term. The distance from E_K/2 to E_K is the error of the former; with the rate
/// at which these distances shrink it gives that of E_K, an error of the final shape. A single step
/// (E_1 = Y_1) is compared with the paper's, which comes from the same Krylov space as its half
/// step. Most runs end after one pass, of two evaluations, or two, of five. All passes before the
/// last together cost as much as the last.
///
/// Where parts of the surface shrink away, as they can with BasisUpdate::Full, the flow is singular
/// and passes converge slowly, or not at all: they end when the distances no longer shrink, or at
/// maxSteps; X is then Y_K.
///
/// The steps are equal because smaller ones where the local error is large do not pay: chosen by
/// the largest local error of a vertex, as many were taken for the same error of the result, since
/// a collapsing spike has a large local error and leaves none.
///
/// @throws SolverFailure  as midpointSteps does.
AutomaticSteps automaticSteps(LaplacianBuilder& laplacians, StepEvaluator& evaluate,
                              const Vertices& X, const AutomaticOptions& options,
                              const Progress& progress);

}  // namespace spectral
