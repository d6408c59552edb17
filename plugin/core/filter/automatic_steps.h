#pragma once

#include <vector>

#include "core/filter/step_evaluator.h"
#include "core/laplacian/laplacian_builder.h"
#include "core/mesh/mesh.h"
#include "core/support/progress.h"
#include "core/support/types.h"

namespace spectral {

/// Part of a surface that errors of automatic steps are not told of: thin parts that pinch off,
/// where the flow is singular, often single vertices.
inline constexpr double kNegligibleArea = 1e-3;

struct AutomaticOptions {
    double tolerance = 0.0;  ///< Largest error over the filtered surface but kNegligibleArea,
                             ///< length units, > 0.
    int maxSteps = 64;       ///< Most steps of one pass, >= 2.
};

/// The limit of the paper's scheme for infinitely many steps, as far as it was found.
struct AutomaticSteps {
    Vertices X;                 ///< n x 3, the filtered shape.
    std::vector<double> sizes;  ///< The fractional powers of the last pass's steps; sum 1.
    double error = 0.0;  ///< Estimated error over the filtered surface but kNegligibleArea, length
                         ///< units.

    /// Part of the input's surface, 0 to 1, on which the estimated error is above the tolerance.
    double singularPart = 0.0;
};

/// The limit of the paper's scheme for K to infinity, to a tolerance.
///
/// The midpoint rule (midpointSteps) runs with K = 1, 2, 4, ... equal steps. Its error is a series
/// in 1/K that starts with the square, so that Richardson's
///     E_K = Y_K + (Y_K - Y_K/2) / 3
/// takes the first term away. How far E_K is from E_K/2 is the error of the latter; with the rate
/// at which these distances have been seen to shrink it tells that of E_K: of the final shape,
/// after the filter has damped the errors of the single steps or not. A single step (E_1 = Y_1) is
/// compared with the paper's, which needs no evaluation of its own: it is of the Krylov space that
/// the half step is of. The passes before the last cost as much as the last.
///
/// Errors are those of all but a thousandth of the filtered surface. Where parts of it shrink away,
/// whole components or the tips of thin ones, the flow is singular, and passes converge slowly:
/// K = 8 is what they are given. Little of the filtered surface is left of them, and they must not
/// hold up all the others. Where more of it is singular, as it can be with BasisUpdate::Full, the
/// passes end when the distances do not shrink any more, or at maxSteps; X is then Y_K.
///
/// Equal steps, because smaller ones where the local error is large do not pay: chosen by the
/// largest local error of a vertex they took as many steps for the same error of the result, since
/// a spike in collapse has a large local error and leaves none.
///
/// @throws SolverFailure  as midpointSteps does.
AutomaticSteps automaticSteps(LaplacianBuilder& laplacians, StepEvaluator& evaluate,
                              const Vertices& X, const AutomaticOptions& options,
                              const Progress& progress);

}  // namespace spectral
