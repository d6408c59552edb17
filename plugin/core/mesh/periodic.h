#pragma once

#include <array>
#include <vector>

#include "core/mesh/mesh.h"

namespace spectral {

/// Pairs of boundary vertices on opposite sides of the bounding box, one the other's translation
/// along an axis: those of a periodic cell. Empty unless all boundary vertices of two sides match,
/// and the surface goes on beyond them: a wall in a side does not. Nor does a tube, whose boundary
/// is its two ends.
std::vector<std::array<Index, 2>> periodicPairs(const Vertices& V, const Faces& F);

/// The most by which the distance of a pair has changed, as a vector, length units.
double largestMismatch(const std::vector<std::array<Index, 2>>& pairs, const Vertices& before,
                       const Vertices& after);

}  // namespace spectral
