#pragma once

#include <optional>
#include <vector>

#include "core/graph/face_graph.h"
#include "core/mesh/surface.h"
#include "core/noise/noise_estimate.h"
#include "core/noise/noise_field.h"
#include "core/support/progress.h"

namespace spectral {

/// The kind of noise on a mesh.
enum class NoiseKind {
    None,          ///< Too little noise to measure.
    Shape,         ///< What looks like noise may be a coarsely sampled, curved shape.
    Tessellation,  ///< Needle triangles between the edges of a CAD part: nothing can be measured.
    Stretched,     ///< Needle triangles, since one axis has another unit (stretchedAxis).
    TooFew,        ///< Too few vertices to tell noise from corners.
    Voxels,        ///< Staircase of the surface of a binary volume, or the faces of its voxels.
    Rounded,       ///< Coordinates were rounded to a grid.
    White,         ///< Independent at every vertex.
    Impulses,      ///< Independent, with large values at many vertices.
    Local,         ///< Independent, of a height that differs from place to place.
    ScanLines,     ///< Independent, on the lines of a scanner: long triangles between them.
    Correlated     ///< Correlated over a few edges, as from scanners.
};

struct Diagnosis {
    NoiseKind kind = NoiseKind::None;
    NoiseEstimate noise;        ///< Estimate after the removal of spikes.
    NoiseField field;           ///< Where it is, if it is Local, Rounded or on ScanLines.
    std::vector<bool> isClean;  ///< n: components and flat parts without it; empty: none are.
    Points X;                   ///< n x 3 positions without spikes.
    Index spikes = 0;           ///< Number of vertices that are spikes.
    std::optional<int> stretchedAxis;  ///< That of another unit than the others.
    Eigen::RowVector3d voxel = Eigen::RowVector3d::Zero();  ///< Voxel size along each axis.
    double stepLength = 0.0;  ///< Along the surface, of the voxels' steps, in cells of the mesh.
    Eigen::Matrix3d voxelAxes = Eigen::Matrix3d::Identity();  ///< Unit axes of the voxels, as rows.

    bool isNoise() const;  ///< Whether its kind is one of noise.

    /// Root mean square height of the noise over all vertices, length units; 0 without noise.
    double rmsHeight() const;
};

/// Classifies the noise by these questions, in order: Is it the surface of a voxel volume? A
/// tessellation? Are there spikes? Is the rest noise or shape? How high is the noise, and over what
/// length is it correlated? The answers rest on medians and median absolute deviations (Hampel
/// 1974), robust against creases and local detail. In doubt it is shape: smooth noise on a fine
/// mesh and detail on a coarse one look alike.
///
/// @param X           n x 3 positions.
/// @param isMeasured  n: whether a vertex counts; not those on rims.
/// @param isKnown     whether the user has given the height: only the last three questions are
///                    asked.
/// @throws Cancelled
Diagnosis diagnose(const FaceGraph& graph, const Points& X, const std::vector<bool>& isMeasured,
                   bool isKnown, const Progress& progress = {});

/// The diagnosis of a whole surface, as Spectral Denoise makes it with nothing chosen.
Diagnosis diagnose(const Surface& surface, const Progress& progress = {});

}  // namespace spectral
