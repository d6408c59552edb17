#pragma once

#include <Eigen/Core>

#include "core/support/types.h"

namespace spectral {

/// Vertex positions, n x 3, in length units.
using Vertices = Eigen::Matrix<double, Eigen::Dynamic, 3>;

/// Triangles, m x 3, vertex indices.
using Faces = Eigen::Matrix<int, Eigen::Dynamic, 3>;

}  // namespace spectral
