#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/mesh.h"

namespace spectral::python {

/// Rows of numbers, contiguous, as NumPy has them.
template <class Scalar>
using Rows =
    Eigen::Map<const Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;
using Table3 = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// For each row, the first one that is equal, as zeros of both signs are, and what is no number.
std::vector<std::int64_t> firstEqualRows(const Rows<double>& rows);

/// New normals of a shape whose vertices have moved.
///
/// Each turns as its surface turns, by the least rotation between the means of the triangles'
/// normals at its corners before and after, of unit length. Of the usual means, weighted by angles,
/// by areas or not at all, the one that is nearest to the normal is taken: normals that are such a
/// mean are so afterwards, and those that were chosen, as on leaves, keep their angle to the
/// surface. One whose triangles have not moved is kept. Normals that were equal at the same
/// position, as along texture seams, stay equal: hard edges stay hard, smooth ones smooth.
///
/// @param before, after  n x 3 vertices.
/// @param F              m x 3 vertex indices.
/// @param N              k x 3 normals.
/// @param which          m x 3 indices of each corner's normal.
Table3 followingNormals(const Rows<double>& before, const Rows<double>& after,
                        const Rows<std::int64_t>& F, const Rows<double>& N,
                        const Rows<std::int64_t>& which);

/// The same for k normals of faces, of one or several triangles; one that is zero is kept, too.
///
/// @param owners  m numbers of the triangles' faces, rows of N.
Table3 followingFaceNormals(const Rows<double>& before, const Rows<double>& after,
                            const Rows<std::int64_t>& F, const Rows<double>& N,
                            const std::int64_t* owners);

}  // namespace spectral::python
