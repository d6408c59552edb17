#pragma once

#include "core/mesh/surface.h"

namespace spectral {

/// Lets vertices of different components at the same point move alike, by the mean of their
/// displacements, where bodies touch in edges, such as labels of a segmentation: they neither part
/// nor overlap. Surfaces that lie over one another, such as two levels of detail or a shape and its
/// hull, do not touch. Where one of the vertices does not move, the others are left alone.
/// @param displacement  n x 3, of the rows of surface.X.
void moveContactsAlike(const Surface& surface, const Components& components,
                       Vertices& displacement);

/// Components that touch others, and have moved away from them.
struct Parting {
    int components = 0;     ///< The smaller one of each pair.
    int all = 0;            ///< Components of the mesh.
    double distance = 0.0;  ///< By which the largest gap has grown, length units.
};

/// Finds components that come apart: vertices within a distance of each other before, and more
/// than it further apart after. A pair of them is enough; those that a grid separates or that
/// are much denser than the rest are missed.
/// @param near  length units, > 0.
Parting partingOf(const Vertices& V, const Faces& F, const Vertices& moved, double near);

}  // namespace spectral
