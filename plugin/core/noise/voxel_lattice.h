#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/noise/face_graph.h"

namespace spectral {

/// Voxel size along each axis if X (n x 3) are the vertices of the surface of a binary volume, from
/// marching cubes or the like; none otherwise.
///
/// The vertices of such a surface are midpoints of grid edges: in units of voxels, one coordinate
/// is a half-integer and two are integers.
std::optional<Eigen::RowVector3d> voxelLattice(const Points& X);

}  // namespace spectral
