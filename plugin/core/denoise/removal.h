#pragma once

#include <vector>

#include "core/graph/face_graph.h"
#include "core/noise/noise_field.h"
#include "core/noise/scan_rays.h"
#include "core/support/progress.h"

namespace spectral {

/// Result of the removal of noise. Each round filters the face normals, moves the vertices to
/// follow them, and rebuilds the operator from the shape. The vertices always start from the
/// original positions: only the normals are filtered repeatedly.
struct Removal {
    Points X;        ///< n x 3 positions.
    int rounds = 0;  ///< Rounds of the normal filter, or linear steps.
};

struct RemovalOptions {
    double height = 0.0;         ///< Standard deviation of the noise, length units.
    NoiseField place;            ///< If there is any: height and edge length of every place.
    double size = 0.0;           ///< Correlation length of the noise, mean edges.
    double meanEdge = 0.0;       ///< Mean edge length, length units.
    bool keepCreases = true;     ///< If false, smooths across creases, too.
    bool isUnderShape = false;   ///< White noise under a shape that is as high, such as ribs.
    bool areImpulses = false;    ///< White noise with many large values.
    bool areScanLines = false;   ///< White noise on long triangles between lines.
    bool areVoxelFaces = false;  ///< Vertices at the corners of voxels, not between their centres.
    ScanRays rays;               ///< That the noise lies along, if there are any.
    std::vector<bool> mayMove;   ///< n: whether a vertex may move.
};

/// Removes noise that is independent at every vertex.
///
/// Where the shape is as high as the noise, such as ribs, takes what has least risk (least_risk.h).
/// Takes linear steps where they do better (linear_steps.h). Otherwise weak, then stronger rounds,
/// until the displacement is smoother than noise (whiteness.h) or its median exceeds that of the
/// noise: the discrepancy principle (Morozov 1966). Unfolds faces that the noise has folded.
///
/// Where the noise is not alike everywhere (`place`), the limits of displacements, the times of the
/// filter and the number of linear steps are those of each place; only noisy places move.
///
/// All constants of this folder and the meshes they were chosen on are in
/// tests/benchmarks/README.md.
Removal removeWhiteNoise(const FaceGraph& graph, const Points& X, const RemovalOptions& options,
                         const Progress& progress);

/// Removes noise correlated over several edges, by rounds whose time and blurs scale with l^2 and
/// whose sweeps scale with l, its correlation length, until the discrepancy principle stops them.
Removal removeCorrelatedNoise(const FaceGraph& graph, const Points& X,
                              const RemovalOptions& options, const Progress& progress);

/// Removes the staircase of voxels; no coordinate moves farther than half a voxel.
/// @param voxel  voxel size along each axis, length units.
/// @param axes   unit axes of the voxels, as rows.
Removal removeVoxelSteps(const FaceGraph& graph, const Points& X, const Eigen::RowVector3d& voxel,
                         const Eigen::Matrix3d& axes, const RemovalOptions& options,
                         const Progress& progress);

}  // namespace spectral
