#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

/// Spectral filtering of triangle meshes: the algorithm, without any user interface or file format.
///
/// Reading order is data order: mesh_check, components -> laplacian -> boundary ->
/// (harmonic_basis | full_spectrum) -> transfer_function -> fractional_filter.
namespace spectral {

/// Vertex positions, n x 3, in length units.
using Vertices = Eigen::Matrix<double, Eigen::Dynamic, 3>;

/// Triangles, m x 3, as indices into the rows of the vertices.
using Faces = Eigen::Matrix<int, Eigen::Dynamic, 3>;

using SparseMatrix = Eigen::SparseMatrix<double>;
using Eigen::Index;

inline constexpr double kPi = 3.14159265358979323846;

}  // namespace spectral
