#pragma once

#include <optional>

#include "core/graph/face_graph.h"

namespace spectral {

/// The axis along which a surface is stretched beyond any slope of a terrain: its triangles stand
/// nearly upright, but seen along this axis they are well shaped, and face one side. Its unit is
/// another one than that of the other two, as where x and y are degrees and z metres.
///
/// @param F  m x 3 triangles.
/// @param X  n x 3 positions.
/// @return   0, 1 or 2; none if there is no such axis.
std::optional<int> stretchedAxis(const Faces& F, const Points& X);

/// Median of the slopes of triangles above the plane across an axis; infinite if they stand
/// upright, 0 without triangles.
double medianSlope(const Faces& F, const Points& X, int axis);

}  // namespace spectral
