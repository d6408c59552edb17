#pragma once

#include <vector>

#include "core/filter/step_evaluator.h"
#include "core/laplacian/laplacian_builder.h"
#include "core/mesh/mesh.h"
#include "core/support/progress.h"
#include "core/support/types.h"

namespace spectral {

/// The way from the input's shape to the filtered one.
struct FractionalSteps {
    Vertices X;                 ///< n x 3, the filtered shape.
    std::vector<double> sizes;  ///< The fractional powers of the steps, in their order; sum 1.
};

/// The paper's scheme: K steps of F^(1/K), each with the Laplacian of the shape that the step
/// before has left. First order in 1/K.
///
/// Kovnatsky et al. 2012, Eq. 11: X_0 = X, X_(i+1) = F^(1/K)(sqrt(A(X_i))) X_i.
///
/// @throws SolverFailure  naming the step, when triangles collapse (LaplacianKind::Cotangent) or an
///                        evaluation fails.
FractionalSteps fixedSteps(LaplacianBuilder& laplacians, StepEvaluator& evaluate, const Vertices& X,
                           int K, BasisUpdate update, const Progress& progress);

/// K equal steps towards the limit of the paper's scheme for K to infinity, of second order in 1/K.
///
/// That limit is the flow dX/ds = log F(sqrt(A(X))) X, s from 0 to 1. The paper's scheme is its
/// exponential Euler method; this is its exponential midpoint rule, with h = 1/K:
///     X_h/2 = F^(h/2)(sqrt(A(X))) X,    X_h = F^h(sqrt(A(X_h/2))) X.
/// A step that fails is taken as two of half its size, these again, down to 1 / finest.
///
/// X_h/2 is computed with fewer digits (StepEvaluator::predict).
///
/// @param finest     >= K.
/// @param firstHalf  X_h/2 of the first step, where it is known.
/// @throws SolverFailure  saying how far it came, when a step of 1 / finest fails.
FractionalSteps midpointSteps(LaplacianBuilder& laplacians, StepEvaluator& evaluate,
                              const Vertices& X, int K, int finest, const Progress& progress,
                              const Vertices* firstHalf = nullptr);

}  // namespace spectral
