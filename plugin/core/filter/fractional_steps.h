#pragma once

#include <vector>

#include "core/filter/step_evaluator.h"
#include "core/laplacian/laplacian_builder.h"
#include "core/mesh/mesh.h"
#include "core/support/progress.h"

namespace spectral {

/// Result of a sequence of fractional steps.
struct FractionalSteps {
    Vertices X;                   ///< n x 3, the filtered shape.
    std::vector<double> sizes;    ///< The fractional power of each step; they sum to 1.
    double errorEstimate = 0.0;   ///< Estimated relative error of all evaluations.
    bool accuracyReached = true;  ///< Whether every evaluation was within its share of accuracy.
    Vertices before{};            ///< While steps are taken: the shape before the last one.
};

/// The paper's scheme: K steps of F^(1/K), each with the Laplacian of the shape left by the
/// previous step. First order in 1/K.
///
/// Kovnatsky et al. 2012, Eq. 11: X_0 = X, X_(i+1) = F^(1/K)(sqrt(A(X_i))) X_i.
///
/// @throws SolverFailure  when triangles collapse or an evaluation fails; it names the step.
FractionalSteps fixedSteps(LaplacianBuilder& laplacians, StepEvaluator& evaluate, const Vertices& X,
                           int K, const Progress& progress);

/// K equal steps towards the limit of the paper's scheme for K to infinity, of second order in 1/K.
///
/// That limit is the flow dX/ds = log F(sqrt(A(X))) X, s from 0 to 1. The paper's scheme is its
/// exponential Euler method; this is its exponential midpoint rule, with h = 1/K:
///     X_h/2 = F^(h/2)(sqrt(A(X))) X,    X_h = F^h(sqrt(A(X_h/2))) X.
/// X_h/2 is computed to fewer digits (StepEvaluator::predict). A step that fails is halved,
/// recursively, down to 1 / finest.
///
/// With firstQuarter, the Laplacian that gives X_h/2 is that of a shape a quarter step ahead,
/// extrapolated from the step before: at the same cost the error is a third to two thirds where
/// thin parts collapse, since areas change much there during a step.
///
/// @param finest        >= K.
/// @param firstHalf     X_h/2 of the first step if it is known, else empty.
/// @param firstQuarter  X_h/4 of the first step, about; or empty.
/// @throws SolverFailure  when a step of 1 / finest fails; it says how far the filter got.
FractionalSteps midpointSteps(LaplacianBuilder& laplacians, StepEvaluator& evaluate,
                              const Vertices& X, int K, int finest, const Progress& progress,
                              Vertices firstHalf = {}, Vertices firstQuarter = {});

}  // namespace spectral
