#pragma once

#include <vector>

#include "core/noise/face_graph.h"
#include "core/noise/noise_estimate.h"
#include "core/support/progress.h"

namespace spectral {

/// What kind of noise all vertices of a mesh have.
enum class NoiseKind {
    None,          ///< Too little to be seen.
    Shape,         ///< What looks like noise may as well be a curved, coarse shape.
    Tessellation,  ///< Needles between the edges of a designed part: nothing can be measured.
    TooFew,        ///< Vertices; noise and corners are the same.
    Voxels,        ///< Steps of the surface of a binary volume.
    White,         ///< Independent at every vertex.
    Impulses,      ///< Independent, with large values at many vertices.
    Correlated     ///< Over some edges, as of scanners.
};

struct Diagnosis {
    NoiseKind kind = NoiseKind::None;
    NoiseEstimate noise;                                    ///< Without the spikes.
    Points X;                                               ///< n x 3 positions without spikes.
    Index spikes = 0;                                       ///< Vertices.
    Eigen::RowVector3d voxel = Eigen::RowVector3d::Zero();  ///< Size along each axis.
};

/// Asks, in this order: Is it a surface of voxels? A tessellation? Are there spikes? Is the rest
/// noise or shape, and how high and large is it? Medians and medians of moduli answer (Hampel
/// 1974), so that creases and details of a part of the shape do not count. In doubt it is shape:
/// smooth noise on a fine mesh and detail on a coarse one look alike.
///
/// @param X           n x 3 positions.
/// @param isMeasured  n: vertices that count, not on rims.
/// @param isKnown     whether the user has given the height: the last three questions alone.
/// @throws Cancelled
Diagnosis diagnose(const FaceGraph& graph, const Points& X, const std::vector<bool>& isMeasured,
                   bool isKnown, const Progress& progress = {});

}  // namespace spectral
