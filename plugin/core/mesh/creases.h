#pragma once

#include <array>
#include <vector>

#include "core/mesh/mesh.h"
#include "core/mesh/sides.h"

namespace spectral {

/// Creases: edges at which the planes of any two triangles differ by more than `angle`, whatever
/// their orientation, each with its two vertices. Three sheets may meet there.
///
/// @param X      n x 3 positions.
/// @param F      m x 3 indices into X.
/// @param edges  of F.
/// @param angle  angle between the planes in degrees: 0 at a flat edge, 90 on a cube.
std::vector<std::array<Index, 2>> creaseEdges(const Vertices& X, const Faces& F,
                                              const SidesByEdge& edges, double angle);

/// Whether each vertex is on a crease, n flags.
std::vector<bool> creaseVertices(const Vertices& X, const Faces& F, double angle);

/// Whether each vertex is on a sharp edge, of more than 50 degrees, that goes on beyond it, n
/// flags.
std::vector<bool> alongSharpEdges(const Vertices& X, const Faces& F, const SidesByEdge& edges);

/// Sharp edges that a filter has rounded.
struct RoundedCreases {
    Index vertices = 0;    ///< On them, but for corners.
    double largest = 0.0;  ///< Displacement of these, length units.
};

/// None where sharp edges moved about as far as the rest.
/// @param alongEdges    n, as alongSharpEdges.
/// @param displacement  n x 3.
RoundedCreases roundedCreases(const std::vector<bool>& alongEdges, const Vertices& displacement);

}  // namespace spectral
