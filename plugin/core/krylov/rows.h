#pragma once

#include <Eigen/Core>
#include <type_traits>

#include "core/support/types.h"

namespace spectral {

/// Maximum number of signals in one Krylov space, and in one series: each number of W or its factor
/// is then read for all of them at once.
inline constexpr int kMaxSignals = 4, kMaxSignalsOfSeries = 8;

/// Signals, one in each column: n x c.
using Signals = Eigen::Ref<const Eigen::MatrixXd>;

/// The values of all signals at a vertex, contiguous in a vector of rows.
template <int Columns, class Scalar = double>
using Row = Eigen::Array<Scalar, 1, Columns, Eigen::RowMajor | Eigen::DontAlign>;

template <int Columns, class Scalar>
Eigen::Map<Row<Columns, Scalar>> rowOf(Scalar* rows, Index i) {
    return Eigen::Map<Row<Columns, Scalar>>(rows + i * Columns);
}
template <int Columns, class Scalar>
Eigen::Map<const Row<Columns, Scalar>> rowOf(const Scalar* rows, Index i) {
    return Eigen::Map<const Row<Columns, Scalar>>(rows + i * Columns);
}

/// Calls a function with the number of columns as a compile-time constant.
template <class Call>
auto withColumns(int columns, const Call& call) {
    switch (columns) {
        case 1: return call(std::integral_constant<int, 1>());
        case 2: return call(std::integral_constant<int, 2>());
        case 3: return call(std::integral_constant<int, 3>());
        default: return call(std::integral_constant<int, kMaxSignals>());
    }
}

}  // namespace spectral
