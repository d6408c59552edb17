#pragma once

#include <vector>

#include "core/mesh/mesh.h"
#include "core/support/types.h"

namespace spectral {

/// The part of a mesh that is a surface: what a Laplacian has entries for.
struct Surface {
    /// n x 3, about the middle of the bounding box: no digits are lost far from the origin.
    Vertices X;
    Faces F;                    ///< m x 3, indices into X; three different corners each.
    std::vector<Index> vertex;  ///< Row of the input for each row of X, ascending.
};

/// Takes the triangles with three different corners, and the vertices that they use, packed.
///
/// @param V  any number of vertices; those of no triangle are left out.
Surface surfaceOf(const Vertices& V, const Faces& F);

}  // namespace spectral
