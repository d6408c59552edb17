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
    double tolerance = 0.0;      ///< Maximum error over all but kNegligibleArea of the filtered
                                 ///< surface, length units, > 0.
    int maxSteps = 64;           ///< Maximum number of steps of one pass, >= 2.
    int passes = 0;              ///< Number of passes, whatever the error; 0: as many as needed.
    bool keepThinParts = false;  ///< For a low-pass: parts thinner than the feature size stay
                                 ///< (thin_parts.h).
    const ThinPartsOfTile* tile = nullptr;  ///< If X is a tile of a surface.
};

/// Approximate limit of the paper's scheme for infinitely many steps.
struct AutomaticSteps {
    FractionalSteps last;  ///< The last pass; X is extrapolated from the last two passes.
    int passes = 0;        ///< 0: this is not the automatic scheme.
    double error = 0.0;    ///< Estimated error of the steps over all but kNegligibleArea of the
                           ///< filtered surface, length units: mostly within a factor of two.

    /// Fraction of the input surface on which the estimated error exceeds the tolerance.
    double singularPart = 0.0;

    double thinPartFactor = 1.0;  ///< The largest one, kept or not (thin_parts.h).
};

/// Computes the limit of the paper's scheme for K to infinity, to a tolerance.
///
/// The midpoint rule (midpointSteps) runs in passes of K = 1, 2, 4, ... equal steps. Its error is a
/// series in 1/K whose leading term is quadratic, so Richardson extrapolation
///     E_K = Y_K + (Y_K - Y_K/2) / 3
/// removes it. The distance from E_K/2 to E_K estimates the error of E_K/2; the rate at which these
/// distances shrink then bounds that of E_K, which ends the passes. A single step (E_1 = Y_1)
/// is compared with the paper's step, which comes from the same Krylov space as its half step. What
/// is reported is not that bound, which is several times the error, but the error as it usually is
/// at such distances (bench_equalizer). Most
/// runs end after one pass (two evaluations) or two passes (five). All earlier passes together cost
/// as much as the last.
///
/// Where parts of the surface shrink away, the flow is singular and passes converge slowly: they
/// stop when the distances no longer shrink, or at maxSteps. E_K is nearer to the limit there, too.
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
