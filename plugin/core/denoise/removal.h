#pragma once

#include <vector>

#include "core/noise/face_graph.h"
#include "core/support/progress.h"

namespace spectral {

/// What removes noise from the positions X: the normals of the faces are filtered, the vertices
/// follow them, and the operator is taken anew from the shape. Each pass begins at X: it is the
/// normals that are filtered, the vertices only show them.
struct Removal {
    Points X;        ///< n x 3
    int rounds = 0;  ///< Weak parts of the filter of the normals, or linear steps.
};

struct RemovalOptions {
    double height = 0.0;    ///< Of the noise, length units.
    double size = 0.0;      ///< Its correlation length, mean edges.
    double meanEdge = 0.0;  ///< Length units.
    bool keepCreases = true;
    bool areImpulses = false;  ///< White noise with many large values.
    std::vector<bool> mayMove;
};

/// Noise that is independent at every vertex.
///
/// Linear steps where they do better (linear_steps.h). Else weak, then stronger rounds, until what
/// they take is smoother than noise (whiteness.h) or the vertices have moved farther than the noise
/// had moved them, by their median: the discrepancy principle (Morozov 1966). Faces that the noise
/// has folded are turned back.
///
/// All constants of this folder and the meshes they were chosen on are in
/// tests/benchmarks/README.md.
Removal removeWhiteNoise(const FaceGraph& graph, const Points& X, const RemovalOptions& options,
                         const Progress& progress);

/// Noise over several edges: rounds in units of its correlation length l, with times of l^2, blurs
/// of l^2, and sweeps of l, until the discrepancy principle ends them.
Removal removeCorrelatedNoise(const FaceGraph& graph, const Points& X,
                              const RemovalOptions& options, const Progress& progress);

/// Steps of voxels: no coordinate moves farther than half a voxel.
/// @param voxel  size along each axis, length units.
Removal removeVoxelSteps(const FaceGraph& graph, const Points& X, const Eigen::RowVector3d& voxel,
                         const RemovalOptions& options, const Progress& progress);

}  // namespace spectral
