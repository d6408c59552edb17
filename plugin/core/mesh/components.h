#pragma once

#include <Eigen/Core>

#include "core/mesh/mesh.h"
#include "core/support/types.h"

namespace spectral {

/// The connected components of a surface; triangles that share a vertex belong together.
struct Components {
    Eigen::VectorXi label;  ///< n labels, 0 <= label < count; -1 for vertices that count to none.
    int count = 0;
};

/// @param F  m x 3 indices in [0, vertexCount); every vertex is in some triangle.
Components connectedComponents(const Faces& F, Index vertexCount);

}  // namespace spectral
