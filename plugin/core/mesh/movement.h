#pragma once

#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
#include "core/mesh/volume.h"

namespace spectral {

/// How far a filter has moved a surface, and what that did to its volume.
struct Movement {
    double maxDisplacement = 0.0;                  ///< Largest vertex displacement, length units.
    double rmsDisplacement = 0.0;                  ///< Root mean square, length units.
    double meanDisplacement = 0.0;                 ///< Mean length, length units.
    double volumeBefore = 0.0, volumeAfter = 0.0;  ///< Signed; meaningful only if hasVolume.
    double limitedShare = 0.0;  ///< Of the area, 0 to 1, at which a bound limited it.
    bool hasVolume = false;     ///< Whether the surface encloses a volume.
    Index foldedFaces = 0;      ///< See foldedFaces().
    PreservedVolumes volumes;   ///< Volumes of the closed components.
};

/// @param X, F          n x 3 positions before, and the triangles.
/// @param displacement  n x 3.
/// @param weight        n, of the vertices in the mean square; not all 0.
/// @param volumes       what was done to them.
Movement movementOf(const Vertices& X, const Faces& F, const Vertices& displacement,
                    const Eigen::VectorXd& weight, const PreservedVolumes& volumes);

/// Number of faces that have folded over: they have turned by more than 90 degrees, and face away
/// from the sum of the faces around them, which where a part of the surface has turned as a whole
/// they do not. Faces of less than 1 % of the mean area after are too small to be seen.
/// @param before, after  n x 3 positions.
Index foldedFaces(const Vertices& before, const Vertices& after, const Faces& F);

/// The largest displacement of the vertices along seams, which are drawn together where they differ
/// by round-off (seams.h); 0 without seams.
/// @param V, moved  vertices of the mesh, before and after.
double largestAtSeams(const Vertices& V, const Vertices& moved, const Surface& surface);

}  // namespace spectral
