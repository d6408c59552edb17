#pragma once

#include <Eigen/Core>

#include "core/mesh/mesh.h"

namespace spectral {

/// Normals of a mesh, in the precision of its host.
template <class Scalar>
struct Normals {
    using Rows = Eigen::Matrix<Scalar, Eigen::Dynamic, 3, Eigen::RowMajor>;
    Rows faces;     ///< m x 3, of unit length; 0 where a face has no area.
    Rows vertices;  ///< n x 3, the sum of those of the faces around, each times its angle there.
};

/// @tparam Scalar  float or double, which everything is computed in.
template <class Scalar>
Normals<Scalar> angleWeightedNormals(const Vertices& V, const Faces& F);

}  // namespace spectral
