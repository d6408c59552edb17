#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "core/graph/face_graph.h"

namespace spectral {

/// Coordinates (n x 3), and those along each axis in ascending order.
struct SortedPoints {
    Points X;
    std::array<std::vector<double>, 3> sorted;

    explicit SortedPoints(Points points);
};

/// A grid that all coordinates lie on.
struct CoordinateGrid {
    Eigen::RowVector3d step;  ///< Distance of its planes along each axis, length units.
};

/// The grid of the vertices, but for a hundredth; none if along some axis there is no
/// grid.
std::optional<CoordinateGrid> coordinateGrid(const SortedPoints& points);

/// Candidates for the axes of a turned lattice, as rows: orthogonal triples of the few directions
/// that the faces of a lattice's surface have (3, or 13 between the centres of voxels). None on
/// other surfaces.
std::vector<Eigen::Matrix3d> latticeAxes(const FaceGraph& graph, const Points& X);

/// The voxels of a binary volume.
struct VoxelLattice {
    Eigen::RowVector3d voxel;  ///< Their size along each axis, length units.
    double edges = 1.0;        ///< Their size in cells of the mesh: more where it is finer.
};

/// The voxels if the vertices are those of the surface of a binary volume, from marching cubes or
/// the like; none otherwise.
///
/// The vertices of such a surface are on the edges of a grid: in its units, two coordinates are
/// integers, and one lies between, at the same level on all edges. Where that is at every third
/// cell only, say, each voxel was divided into as many: the volume was resampled.
///
/// @param areAllOn  whether all but a hundredth of the vertices must be on it, or else four fifths:
///                  then the levels that several vertices share make the grid.
std::optional<VoxelLattice> voxelLattice(const SortedPoints& points, bool areAllOn = true);

}  // namespace spectral
