#pragma once

#include <Eigen/Core>

#include "core/mesh/mesh.h"

namespace spectral {

/// Lowers a displacement where it is longer than a bound, and smoothly less around there, so that
/// no ridge is left where the bound begins.
///
/// The strength of a vertex is at most t = min(1, bound / length). As a limiter in audio looks
/// ahead, it is the least t within some rings, averaged over as many: a mean of numbers that are at
/// most t each, and so at most t.
///
/// @param F             m x 3 triangles.
/// @param areas         n, of the vertices.
/// @param bound         length units, > 0; 0: none.
/// @param rings         of vertices, >= 1, within which the strength changes.
/// @param displacement  n x 3; no row is longer than the bound afterwards, to round-off.
/// @return  the share of the area, 0 to 1, at which it was longer.
double limitDisplacement(const Faces& F, const Eigen::VectorXd& areas, double bound, int rings,
                         Vertices& displacement);

/// The rings for a filter whose effects vary over so many edges: at least 4, within which those of
/// a selection fade out, at most 64, beyond which it would take longer than the filter.
int ringsWithin(double edges);

}  // namespace spectral
