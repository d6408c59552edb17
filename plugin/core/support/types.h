#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace spectral {

using Eigen::Index;
using SparseMatrix = Eigen::SparseMatrix<double>;

inline constexpr double kPi = 3.14159265358979323846;

}  // namespace spectral
