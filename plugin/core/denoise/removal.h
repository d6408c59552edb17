#pragma once

#include <vector>

#include "core/graph/face_graph.h"
#include "core/noise/noise_field.h"
#include "core/noise/scan_rays.h"
#include "core/support/progress.h"

namespace spectral {

/// Result of the removal of noise.
struct Removal {
    Points X;        ///< n x 3 positions.
    int rounds = 0;  ///< Rounds of the normal filter, or linear steps.
};

struct RemovalOptions {
    NoiseField noise;           ///< Height and edge length of every place.
    double size = 0.0;          ///< Correlation length of the noise, mean edges; 0: white noise.
    double meanEdge = 0.0;      ///< Mean edge length, length units.
    bool keepCreases = true;    ///< If false, smooths across creases, too.
    bool isUnderShape = false;  ///< White noise under a shape that is as high, such as ribs.
    bool isEven = false;        ///< Nearly white: isOtherNoise; linear steps expect white noise.
    bool areImpulses = false;   ///< White noise with many large values.
    bool areScanLines = false;  ///< White noise on long triangles between lines.
    ScanRays rays;              ///< That the noise lies along, if there are any.
    std::vector<bool> mayMove;  ///< n: whether a vertex may move.
};

/// Removes noise of known heights. Vertices move along normals only, as far as the noise can have
/// moved them.
///
/// Where the shape is as high as white noise, such as ribs, takes what has least risk
/// (least_risk.h). Otherwise linear steps in the places where they do better (linear_steps.h).
/// Elsewhere, and for correlated noise, rounds: each filters the normals of the faces, moves the
/// vertices to follow them and rebuilds the operator from the shape. The vertices always start from
/// the original positions: only the normals are filtered repeatedly. The limits of displacements
/// and the times of the filter are those of each place.
///
/// The rounds end when the displacement is smoother than white noise (whiteness.h), or its median
/// exceeds that of the noise: the discrepancy principle (Morozov 1966). Flat parts are then
/// averaged farther, if noise splitting (noise_splitting.h) measures that this is nearer to the
/// truth. Those for correlated noise have times and blurs that scale with l^2 and sweeps that scale
/// with l, its correlation length. In the end, faces that the noise has folded are unfolded.
///
/// All constants of this folder and the meshes they were chosen on are in
/// tests/benchmarks/README.md.
Removal removeNoise(const FaceGraph& graph, const Points& X, const RemovalOptions& options,
                    const Progress& progress);

/// Removes the staircase of voxels by rounds; no coordinate moves farther than half a voxel.
/// @param voxel   voxel size along each axis, length units.
/// @param axes    unit axes of the voxels, as rows.
/// @param length  over which to filter, voxels.
Removal removeVoxelSteps(const FaceGraph& graph, const Points& X, const Eigen::RowVector3d& voxel,
                         const Eigen::Matrix3d& axes, double length, const RemovalOptions& options,
                         const Progress& progress);

}  // namespace spectral
