#pragma once

#include "core/filter/fractional_steps.h"
#include "core/filter/step_evaluator.h"
#include "core/filter/thin_parts.h"
#include "core/laplacian/laplacian_builder.h"
#include "core/mesh/mesh.h"
#include "core/support/progress.h"
#include "core/support/types.h"

namespace spectral {

/// Fraction of the surface that error estimates of automatic steps ignore: there the flow is nearly
/// singular, often at single vertices.
inline constexpr double kNegligibleArea = 1e-3;

struct AutomaticOptions {
    double tolerance = 0.0;      ///< Maximum error over all but kNegligibleArea of the input
                                 ///< surface, length units, > 0.
    int maxSteps = 64;           ///< Maximum number of steps of one pass, >= 2.
    int passes = 0;              ///< Number of passes, whatever the error; 0: as many as needed.
    bool keepThinParts = false;  ///< For a low-pass: parts thinner than the feature size stay
                                 ///< (thin_parts.h).
    const ThinPartsOfTile* tile = nullptr;  ///< If X is a tile of a surface: errors are those of
                                            ///< its inner vertices.
};

/// Approximate limit of the paper's scheme for infinitely many steps.
struct AutomaticSteps {
    FractionalSteps last;  ///< The last pass; X is extrapolated from the last two passes.
    int passes = 0;        ///< 0: this is not the automatic scheme.
    double error = 0.0;    ///< Estimated error of the steps over all but kNegligibleArea of the
                           ///< input surface, without what collapses to less than a tenth of its
                           ///< area, length units: mostly half to three times the error.

    /// Fraction of the input surface on which the estimated error exceeds the tolerance, what
    /// collapses included.
    double singularPart = 0.0;

    double thinPartFactor = 1.0;  ///< The largest one, kept or not (thin_parts.h).
};

/// Computes the limit of the paper's scheme for K to infinity, to a tolerance.
///
/// The midpoint rule (midpointSteps) runs in passes of K = 1, 2, 4, ... equal steps. Its error is a
/// series in 1/K whose leading term is quadratic, so from K = 8 on Richardson extrapolation
///     E_K = Y_K + (Y_K - Y_K/2) / 3
/// removes it; before, E_K = Y_K. A single step is compared with the paper's step, which comes from
/// the same Krylov space as its half step: their distance d is an error of first order. That of the
/// midpoint rule is d times the ratio of d to the displacement, times the ratio by which areas
/// shrink in the last three quarters of the step; where they grow, at most d / 10. Later, the
/// distance from E_K/2 to E_K and the rate at which such distances shrink tell the error of E_K.
/// Most runs end after one pass (two evaluations) or two passes (six). All earlier passes together
/// cost as much as the last.
///
/// Where parts of the surface collapse, the flow is singular and passes converge slowly. These
/// parts do not hold up the rest: passes end when the error everywhere else is within the
/// tolerance, when distances no longer shrink, or at maxSteps.
///
/// The same number of passes gives the same result, so a run can be repeated exactly, and the tiles
/// of a surface agree.
///
/// The steps are equal because adapting them to the largest local error at a vertex does not pay: a
/// collapsing spike has a large local error, but contributes none to the result.
///
/// @throws SolverFailure  as midpointSteps does.
AutomaticSteps automaticSteps(LaplacianBuilder& laplacians, StepEvaluator& evaluate,
                              const Vertices& X, const AutomaticOptions& options,
                              const Progress& progress);

}  // namespace spectral
