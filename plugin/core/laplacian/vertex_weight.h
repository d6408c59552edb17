#pragma once

#include <vector>

#include "core/laplacian/interior.h"
#include "core/laplacian/laplacian.h"
#include "core/mesh/surface.h"

namespace spectral {

/// Which part of a mesh is filtered, and how strongly.
struct WeightOptions {
    std::vector<bool> selected;  ///< n, whether to filter each vertex; empty: all.
    Eigen::VectorXd weight;      ///< n, 0 to 1: fraction of its change each vertex makes; empty: 1.
};

/// @throws InvalidOption  when nothing is selected, or a weight is not between 0 and 1.
void checkWeights(const WeightOptions& options);

/// Whether each vertex of a surface, or one of its copies, is selected in the mesh.
std::vector<bool> selectedOn(const Surface& surface, const std::vector<bool>& selected);

/// A smooth weight that is 1 on a selection and exactly 0 beyond about `width` from it.
///
/// It is a smooth step applied to the solution m of W m = -D m / l^2 outside the selection, with
/// m = 1 on it, which decays like exp(-distance / l); l is a third of the width, and the step
/// starts at exp(-3).
///
/// @param components  connected components of the surface, n vertices.
/// @param selected    n, whether each vertex is selected.
/// @param width       length units, > 0.
/// @return  n weights, 0 to 1, with zero slope at both ends, so that weighting leaves no crease.
/// @throws SolverFailure  when the system is singular to working precision.
Eigen::VectorXd selectionWeight(const Laplacian& laplacian, const Components& components,
                                const std::vector<bool>& selected, double width);

/// Fraction of its change that each vertex of a surface makes, 0 to 1. Around a selection it falls
/// smoothly to 0 within about a feature size (selectionWeight); at fixed vertices it is 0.
Eigen::VectorXd vertexWeight(const WeightOptions& options, const Surface& surface,
                             const Interior& interior, const Laplacian& laplacian,
                             double featureSize);

}  // namespace spectral
