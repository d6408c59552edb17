#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <functional>

namespace spectral {

using Eigen::Index;
using SparseMatrix = Eigen::SparseMatrix<double>;

/// Gain at a frequency omega = sqrt(lambda) >= 0, in radians per length unit.
using Gain = std::function<double(double omega)>;

inline constexpr double kPi = 3.14159265358979323846;

}  // namespace spectral
