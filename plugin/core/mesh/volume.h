#pragma once

#include <vector>

#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"

namespace spectral {

struct PreservedVolumes {
    int preserved = 0;  ///< Closed components whose volume was restored.
    int open = 0;       ///< Components without a volume: open or inconsistently oriented.
    int lost = 0;       ///< Closed components whose volume no offset within the limit restores.
};

/// Restores the volume of every closed component by an offset along its normals.
///
/// The offset is the lost volume over the area. On long or thin shapes this moves vertices less
/// than scaling about the centroid, and it can keep parts fixed.
///
/// @param X0         n x 3 positions with the original volumes.
/// @param F          m x 3 indices into X.
/// @param weight     n factors on the offset, >= 0; a vertex of weight 0 stays fixed.
/// @param maxOffset  largest offset of a vertex, relative to the largest displacement in its
///                   component: with almost no volume, Newton's method may diverge.
/// @param X          n x 3 positions, updated.
PreservedVolumes preserveVolumes(const Vertices& X0, const Faces& F, const Components& components,
                                 const Eigen::VectorXd& weight, double maxOffset, Vertices& X);

}  // namespace spectral
