#pragma once

#include "core/mesh/mesh.h"

namespace spectral {

/// Diagonal of the axis-aligned bounding box.
/// @param V  n x 3, n >= 1.
double boundingBoxDiagonal(const Vertices& V);

/// Lengths of a mesh that sizes and defaults refer to, length units.
struct MeshLengths {
    double diagonal = 0.0;  ///< Of the bounding box of all vertices: percentages refer to it.
    double meanEdge = 0.0;  ///< meanEdgeLength.
    double surfaceDiagonal = 0.0;  ///< Of the bounding box of the corners of triangles, without any
                                   ///< that of all vertices: defaults refer to it.
    Index outside = 0;             ///< Number of vertices outside the box of the corners.
    /// A value that may stand for missing data, as -9999 in a terrain.
    struct Filler {
        int axis = 0;
        double value = 0.0;
        Index vertices = 0;  ///< How many have it; 0: none is found.
        bool isLowest = false;
    } filler{};
};

/// @param V  n x 3; positions that are not finite do not count for the diagonals.
/// @param F  m x 3 indices in [0, n); n and m may be 0.
MeshLengths lengthsOf(const Vertices& V, const Faces& F);

/// Mean side length over all triangles, counting interior edges twice; 0 without triangles. Left
/// out are walls around missing data: sides that are more than 64 times as long as half of all, and
/// lead to the lowest or highest vertices, from which all others are farther than from each other.
double meanEdgeLength(const Vertices& V, const Faces& F);

/// Finds the lowest or highest coordinate of a height field, if several vertices have it, the
/// others are farther from it than from each other, and no vertical wall leads to it.
MeshLengths::Filler fillerOf(const Vertices& V, const Faces& F);

/// Default feature size: six mean edges, at most 5 % of the diagonal of the bounding box.
///
/// At six edges a Gaussian low-pass removes sampling noise: it keeps 4 % of the shortest wave that
/// a mesh can represent, two edges long. The bound preserves the shape of a coarse mesh.
///
/// @param meanEdge, diagonal  length units; meanEdge = 0 gives the bound. The diagonal is that of
///                            the surface (MeshLengths).
double defaultFeatureSize(double meanEdge, double diagonal);

/// Default size of the smallest details of an equalizer: three mean edges, at most 2.5 % of the
/// diagonal, half of the default feature size.
///
/// A mesh cannot represent waves shorter than two edges, and resolves waves of three edges poorly.
/// The bound keeps the bands of a coarse mesh below the size of its shape.
double defaultSmallestSize(double meanEdge, double diagonal);

/// Default tolerance of automatic steps: 0.05 % of the diagonal, half a pixel of a mesh shown 1,000
/// pixels wide.
inline double defaultTolerance(const MeshLengths& mesh) { return 0.0005 * mesh.surfaceDiagonal; }

/// Total area of the triangles.
double surfaceArea(const Vertices& V, const Faces& F);

/// Signed volume by the divergence theorem, positive for outward orientation. For an open surface,
/// that of its cone over the centre of the bounding box. 0 if parts cancel up to round-off.
/// @param V  n x 3, n >= 1.
double signedVolume(const Vertices& V, const Faces& F);

/// Whether a surface is closed and consistently oriented, as far as its integrals tell up to
/// round-off: that of the normal is 0, and that of position and normal, x n^T, the volume times the
/// identity. The first alone holds for an open tube, too.
bool enclosesVolume(const Vertices& V, const Faces& F);

}  // namespace spectral
