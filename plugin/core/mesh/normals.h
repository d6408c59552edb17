#pragma once

#include <Eigen/Core>

#include "core/mesh/mesh.h"

namespace spectral {

/// Normals of a mesh, in the precision of its host.
template <class Scalar>
struct Normals {
    using Rows = Eigen::Matrix<Scalar, Eigen::Dynamic, 3, Eigen::RowMajor>;
    Rows faces;     ///< m x 3, unit length; 0 for a face of zero area.
    Rows vertices;  ///< n x 3, sum of the adjacent face normals, weighted by their angles.
};

/// @tparam Scalar  precision of the computation, float or double.
template <class Scalar>
Normals<Scalar> angleWeightedNormals(const Vertices& V, const Faces& F);

}  // namespace spectral
