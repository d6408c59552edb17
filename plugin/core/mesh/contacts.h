#pragma once

#include "core/mesh/surface.h"

namespace spectral {

/// Lets vertices of different components at the same point move alike, by the mean of their
/// displacements: bodies that touch there, such as labels of a segmentation, neither part nor
/// overlap. Where one of them does not move, the others are left alone.
/// @param displacement  n x 3, of the rows of surface.X.
void moveContactsAlike(const Surface& surface, const Components& components,
                       Vertices& displacement);

}  // namespace spectral
