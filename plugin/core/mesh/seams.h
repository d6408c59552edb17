#pragma once

#include <vector>

#include "core/mesh/mesh.h"

namespace spectral {

/// Seams along which a surface was cut, e.g. for its texture, or triangle by triangle, as in STL
/// files: boundary edges with the same end points are one edge. So are two whose ends differ by
/// round-off, if these are near each other and nothing else: their distances are at most a fiftieth
/// of the shortest side at the ends, and no third edge is as near. Closed parts that only touch
/// have no boundary, and stay apart.
struct Seams {
    std::vector<int> first;  ///< n: for each vertex the first one it is one with, often itself;
                             ///< empty if all are apart.
    int nearby =
        0;  ///< Number of further vertices on the boundary that would coincide if positions
            ///< were rounded to a millionth of the bounding box diagonal: where more than
            ///< two edges are near each other, it is not known which belong together.
};

/// @param X  n x 3 positions, finite.
/// @param F  m x 3 indices into X; the corners of each triangle are distinct.
Seams findSeams(const Vertices& X, const Faces& F);

}  // namespace spectral
