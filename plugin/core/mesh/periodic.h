#pragma once

#include <array>
#include <vector>

#include "core/mesh/mesh.h"

namespace spectral {

/// Pairs of boundary vertices on opposite sides, one the other's translation along an axis: those
/// of a periodic cell. Empty unless all boundary vertices of two sides of the bounding box match,
/// or all of the boundary along two axes; and the surface goes on beyond these sides: the walls of
/// a duct do not. Nor is a tube a cell, whose boundary is its two ends.
std::vector<std::array<Index, 2>> periodicPairs(const Vertices& V, const Faces& F);

/// The most by which the distance of a pair has changed, as a vector, length units.
double largestMismatch(const std::vector<std::array<Index, 2>>& pairs, const Vertices& before,
                       const Vertices& after);

}  // namespace spectral
