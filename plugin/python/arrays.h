#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <string>
#include <type_traits>
#include <utility>

#include "core/mesh/mesh.h"

namespace spectral::python {

namespace nb = nanobind;

/// Rows of three contiguous numbers, as NumPy makes them. The package converts what users pass.
using Positions = nb::ndarray<const double, nb::numpy, nb::shape<-1, 3>, nb::c_contig>;
using Indices = nb::ndarray<const int, nb::numpy, nb::shape<-1, 3>, nb::c_contig>;
using Table = nb::ndarray<const double, nb::numpy, nb::shape<-1, -1>, nb::c_contig>;
using Pairs = nb::ndarray<const double, nb::numpy, nb::shape<-1, 2>, nb::c_contig>;
using Numbers = nb::ndarray<const double, nb::numpy, nb::shape<-1>, nb::c_contig>;
using Flags = nb::ndarray<const bool, nb::numpy, nb::shape<-1>, nb::c_contig>;

template <class Array>
auto mapOf(const Array& array, Eigen::Index columns) {
    using Scalar = std::remove_const_t<typename Array::Scalar>;
    using Rows = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    return Eigen::Map<const Rows>(array.data(), static_cast<Eigen::Index>(array.shape(0)), columns);
}

/// Hands the memory of a matrix to NumPy, without a copy: columns are contiguous, as in the core.
template <class Matrix>
nb::object given(Matrix&& matrix) {
    using M = std::decay_t<Matrix>;
    auto* owned = new M(std::forward<Matrix>(matrix));
    nb::capsule owner(owned, [](void* p) noexcept { delete static_cast<M*>(p); });
    const auto rows = static_cast<std::size_t>(owned->rows());
    const auto columns = static_cast<std::size_t>(owned->cols());
    if constexpr (M::ColsAtCompileTime == 1)
        return nb::cast(nb::ndarray<nb::numpy, typename M::Scalar>(owned->data(), {rows}, owner));
    else
        return nb::cast(nb::ndarray<nb::numpy, typename M::Scalar>(
            owned->data(), {rows, columns}, owner, {1, static_cast<std::int64_t>(rows)}));
}

/// A copy with contiguous rows, which most libraries expect of coordinates.
template <class Matrix>
nb::object givenByRows(const Matrix& matrix) {
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    auto* owned = new Rows(matrix);
    nb::capsule owner(owned, [](void* p) noexcept { delete static_cast<Rows*>(p); });
    return nb::cast(nb::ndarray<nb::numpy, double>(
        owned->data(),
        {static_cast<std::size_t>(owned->rows()), static_cast<std::size_t>(owned->cols())}, owner));
}

/// Hands the memory of a vector or a text to NumPy: an array, or rows of `columns` numbers.
template <class Vector>
nb::object givenRows(Vector&& vector, std::size_t columns = 0) {
    using V = std::decay_t<Vector>;
    using Scalar =
        std::conditional_t<std::is_same_v<V, std::string>, std::uint8_t, typename V::value_type>;
    auto* owned = new V(std::forward<Vector>(vector));
    nb::capsule owner(owned, [](void* p) noexcept { delete static_cast<V*>(p); });
    auto* const data = reinterpret_cast<Scalar*>(owned->data());
    if (columns == 0) return nb::cast(nb::ndarray<nb::numpy, Scalar>(data, {owned->size()}, owner));
    return nb::cast(
        nb::ndarray<nb::numpy, Scalar>(data, {owned->size() / columns, columns}, owner));
}

}  // namespace spectral::python
