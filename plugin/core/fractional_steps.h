#pragma once

#include <vector>

#include "laplacian_builder.h"
#include "progress.h"
#include "step_evaluator.h"
#include "types.h"

namespace spectral {

/// The way from the input's shape to the filtered one.
struct FractionalSteps {
    Vertices X;                 ///< n x 3, the filtered shape.
    std::vector<double> sizes;  ///< The fractional powers of the steps, in their order; sum 1.

    /// For automatic steps: estimated largest error of any vertex against infinitely many steps,
    /// length units, summed over the steps; 0 for fixed steps, which have no estimate.
    double stepError = 0.0;

    /// For automatic steps: the part of the filter, 0 to 1, during which the tolerance was not met
    /// although the steps were as small as they may be.
    double singularPart = 0.0;
};

/// The paper's scheme: K steps of F^(1/K), each with the Laplacian of the shape that the step
/// before has left. First order in 1/K.
///
/// Kovnatsky et al. 2012, Eq. 11: X_0 = X, X_(i+1) = F^(1/K)(sqrt(A(X_i))) X_i.
///
/// @throws SolverFailure  naming the step, when triangles collapse (LaplacianKind::Cotangent) or an
///                        evaluation fails.
FractionalSteps fixedSteps(const LaplacianBuilder& laplacians, StepEvaluator& evaluate,
                           const Vertices& X, int K, BasisUpdate update, const Progress& progress);

struct AutomaticOptions {
    double tolerance = 0.0;  ///< Largest error of any vertex, length units, > 0.
    int maxSteps = 100;      ///< No step is smaller than 1 / maxSteps.
};

/// The limit of the paper's scheme for K to infinity, to a tolerance.
///
/// That limit is the flow dX/ds = log F(sqrt(A(X))) X, s from 0 to 1. It is integrated by the
/// exponential midpoint rule, second order in the step h:
///     X_h/2 = F^(h/2)(sqrt(A(X))) X,    X_h = F^h(sqrt(A(X_h/2))) X.
/// The same two Laplacians give a second second-order result, Richardson's extrapolation of one
/// whole and two half steps of the paper's scheme,
///     2 F^(h/2)(sqrt(A(X_h/2))) X_h/2 - F^h(sqrt(A(X))) X,
/// and the distance of the two estimates the error of the step. Every step is chosen so that its
/// error is at most its share h of the tolerance; a step that fails, or whose Laplacian cannot be
/// factorized, is tried again with half its size. Where the flow is singular (thin parts that pinch
/// off) no step is small enough: from 1 / maxSteps on a step is taken as it is, and told of.
FractionalSteps automaticSteps(const LaplacianBuilder& laplacians, StepEvaluator& evaluate,
                               const Vertices& X, const AutomaticOptions& options,
                               const Progress& progress);

}  // namespace spectral
