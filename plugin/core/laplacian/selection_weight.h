#pragma once

#include <vector>

#include "core/laplacian/laplacian.h"
#include "core/mesh/surface.h"

namespace spectral {

/// A smooth weight that is 1 on a selection and exactly 0 beyond about a distance from it.
///
/// It is a smooth step of the solution m of W m = -D m / l^2 around the selection, m = 1 on it,
/// that falls like exp(-distance / l): l is a third of the width, and the step begins at exp(-3).
///
/// @param components  of the surface, n vertices.
/// @param selected    n.
/// @param width       length units, > 0.
/// @return  n weights, 0 to 1; without a slope at both ends, so that what is weighted has no
/// crease.
/// @throws SolverFailure  when the system is singular to working precision.
Eigen::VectorXd selectionWeight(const Laplacian& laplacian, const Components& components,
                                const std::vector<bool>& selected, double width);

}  // namespace spectral
