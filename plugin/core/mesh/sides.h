#pragma once

#include <vector>

#include "core/mesh/mesh.h"

namespace spectral {

/// A side of a triangle.
struct Side {
    int low, high;  ///< Its vertices.
    int face;
    int opposite;  ///< Number, 0 to 2, of the corner opposite to it.

    bool isOfEdge(const Side& other) const { return low == other.low && high == other.high; }
};

/// All sides of all triangles; those of one edge are next to each other, ascending by face.
std::vector<Side> sidesByEdge(const Faces& F);

/// Calls work(first, end) for the sides of every edge.
template <class Work>
void forEachEdge(const std::vector<Side>& sides, const Work& work) {
    for (auto first = sides.begin(); first != sides.end();) {
        auto end = first + 1;
        while (end != sides.end() && end->isOfEdge(*first)) ++end;
        work(first, end);
        first = end;
    }
}

}  // namespace spectral
