#pragma once

#include <vector>

#include "core/mesh/mesh.h"

namespace spectral {

/// Where a surface was cut apart, as at the seams of its texture: two boundary edges whose ends are
/// at the same points are one edge. Closed parts that only touch have no boundary, and stay apart.
struct Seams {
    std::vector<int> first;  ///< n: for every vertex the first of those that are one with it, often
                             ///< itself; empty when no two are one.
    int nearby = 0;  ///< Vertices that would be one with another, were positions rounded to a
                     ///< millionth of the bounding box diagonal, as some exporters leave them.
};

/// @param X  n x 3, finite.
/// @param F  m x 3 indices into X; the corners of a triangle differ.
Seams findSeams(const Vertices& X, const Faces& F);

}  // namespace spectral
