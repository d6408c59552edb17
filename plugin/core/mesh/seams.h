#pragma once

#include <vector>

#include "core/mesh/mesh.h"

namespace spectral {

/// Seams along which a surface was cut, e.g. for its texture: boundary edges with the same end
/// points are one edge. Closed parts that only touch have no boundary, and stay apart.
struct Seams {
    std::vector<int> first;  ///< n: for each vertex the first one it coincides with, often itself;
                             ///< empty if no two coincide.
    int nearby = 0;  ///< Number of further vertices that would coincide if positions were rounded
                     ///< to a millionth of the bounding box diagonal, as by some exporters.
};

/// @param X  n x 3 positions, finite.
/// @param F  m x 3 indices into X; the corners of each triangle are distinct.
Seams findSeams(const Vertices& X, const Faces& F);

}  // namespace spectral
