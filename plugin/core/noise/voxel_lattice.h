#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/noise/face_graph.h"

namespace spectral {

/// The size of the voxels along each axis, if X (n x 3) are the vertices of the surface of a binary
/// volume, from marching cubes or the like; none otherwise.
///
/// Such a surface passes through the middles of grid edges: of a vertex' coordinates, in voxels,
/// one ends on a half and two on whole numbers.
std::optional<Eigen::RowVector3d> voxelLattice(const Points& X);

}  // namespace spectral
