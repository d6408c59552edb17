#pragma once

#include <vector>

#include "core/laplacian/interior.h"
#include "core/laplacian/laplacian.h"
#include "core/mesh/surface.h"

namespace spectral {

/// Which part of a mesh is filtered, and how much of it.
struct WeightOptions {
    std::vector<bool> selected;  ///< n: what to filter; empty: everything.
    Eigen::VectorXd weight;  ///< n, 0 to 1: part of its change that each vertex makes; empty: 1.
};

/// @throws InvalidOption  when nothing is selected, or a weight is not between 0 and 1.
void checkWeights(const WeightOptions& options);

/// Part of its change that each vertex of a surface makes, 0 to 1. Around a selection it falls
/// smoothly to 0 within about a feature size, see selectionWeight; at fixed vertices it is 0.
Eigen::VectorXd vertexWeight(const WeightOptions& options, const Surface& surface,
                             const Interior& interior, const Laplacian& laplacian,
                             double featureSize);

}  // namespace spectral
