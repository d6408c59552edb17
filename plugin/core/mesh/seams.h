#pragma once

#include <vector>

#include "core/mesh/mesh.h"
#include "core/mesh/sides.h"

namespace spectral {

/// A vertex that hangs on an edge of the boundary, as between levels of detail, in octrees and
/// castellated surfaces: the edge lies along finer ones, of which the vertex is an end.
struct Hanging {
    int vertex;
    int from, to;  ///< Ends of the edge.
    double share;  ///< Of its length, between 0 at from and 1 at to.
    int side;      ///< 3 face + corner of the edge's triangle.
    bool follows;  ///< Whether the vertex has to stay on it; no two edges may bend each other.
};

/// Seams along which a surface was cut, e.g. for its texture, or triangle by triangle, as in STL
/// files: boundary edges with the same end points are one edge. So are two whose ends differ by
/// round-off, if these are near each other and nothing else: their distances are at most a fiftieth
/// of the shortest side at the ends, and no third edge is as near. Closed parts that only touch
/// have no boundary, and stay apart.
struct Seams {
    std::vector<int> first;  ///< n: for each vertex the first one it is one with, often itself;
                             ///< empty if all are apart.
    std::vector<Hanging> hanging{};  ///< Between first ones; edges by their lengths, descending.
    int nearby =
        0;  ///< Number of further vertices on the boundary that would coincide if positions
            ///< were rounded to a millionth of the bounding box diagonal: where more than
            ///< two edges are near each other, it is not known which belong together.
};

/// @param X  n x 3 positions, finite.
/// @param F  m x 3 indices into X; the corners of each triangle are distinct.
/// @param edges  of F.
Seams findSeams(const Vertices& X, const Faces& F, const SidesByEdge& edges);

}  // namespace spectral
