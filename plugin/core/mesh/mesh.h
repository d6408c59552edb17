#pragma once

#include <Eigen/Core>

#include "core/support/types.h"

namespace spectral {

/// Vertex positions, n x 3, in length units.
using Vertices = Eigen::Matrix<double, Eigen::Dynamic, 3>;

/// Triangles, m x 3, vertex indices.
using Faces = Eigen::Matrix<int, Eigen::Dynamic, 3>;

/// Those of somebody else, by rows or by columns, who keeps them while they are viewed.
using VerticesView = Eigen::Ref<const Vertices, 0, Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>>;
using FacesView = Eigen::Ref<const Faces, 0, Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>>;

/// Views n rows of three contiguous numbers.
template <class Scalar>
auto viewOfRows(const Scalar* numbers, Index n) {
    using Columns = const Eigen::Matrix<Scalar, Eigen::Dynamic, 3>;
    using Strides = Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>;
    return Eigen::Map<Columns, 0, Strides>(numbers, n, 3, Strides(1, 3));
}

}  // namespace spectral
