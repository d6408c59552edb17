#pragma once

#include <vector>

#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"

namespace spectral {

struct PreservedVolumes {
    int preserved = 0;  ///< Closed components that have their volume back.
    int open = 0;       ///< Components that have no volume: open, or of inconsistent orientation.
    int lost = 0;       ///< Closed components that only too large an offset, if any, gives their
                        ///< volume back.
};

/// Gives every closed component its volume back, by an offset along the normals of its shape.
///
/// An offset moves the surface by volume / area, less than a scale about the centroid does where a
/// shape is long or thin, and can leave parts where they are.
///
/// @param X0          n x 3 positions that have the volumes.
/// @param F           m x 3 indices into X.
/// @param weight      n factors of the offset, >= 0; a vertex of weight 0 stays where it is.
/// @param mostOffset  largest offset of a vertex, relative to the largest displacement in its
///                    component. Next to no volume, Newton's method goes anywhere.
/// @param X           n x 3, moved.
PreservedVolumes preserveVolumes(const Vertices& X0, const Faces& F, const Components& components,
                                 const Eigen::VectorXd& weight, double mostOffset, Vertices& X);

}  // namespace spectral
