#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/graph/face_graph.h"

namespace spectral {

/// A grid that all coordinates lie on.
struct CoordinateGrid {
    Eigen::RowVector3d step;  ///< Distance of its planes along each axis, length units.
    Eigen::Matrix<int, Eigen::Dynamic, 3> multiples;  ///< n x 3: each coordinate in steps.
};

/// The grid of the vertices X (n x 3); none if along some axis there is no grid.
/// @param areAllOn  whether all but a hundredth of the vertices must be on it, or else four fifths:
///                  then the levels that several vertices share make the grid.
std::optional<CoordinateGrid> coordinateGrid(const Points& X, bool areAllOn = true);

/// Candidates for the axes of a turned lattice, as rows: orthogonal triples of the few directions
/// that the faces of a lattice's surface have (3, or 13 between the centres of voxels). None on
/// other surfaces.
std::vector<Eigen::Matrix3d> latticeAxes(const FaceGraph& graph, const Points& X);

/// Voxel size along each axis if the vertices on a grid are those of the surface of a binary
/// volume, from marching cubes or the like; none otherwise.
///
/// The vertices of such a surface are midpoints of grid edges: in units of voxels, one coordinate
/// is a half-integer and two are integers.
std::optional<Eigen::RowVector3d> voxelLattice(const CoordinateGrid& grid, bool areAllOn = true);

}  // namespace spectral
