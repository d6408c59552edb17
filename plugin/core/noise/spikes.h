#pragma once

#include <vector>

#include "core/noise/face_graph.h"

namespace spectral {

/// Single vertices far off the surface along its normals.
struct Spikes {
    Eigen::VectorXd height;  ///< n: along N, length units; 0 where there is no spike.
    Points N;                ///< n x 3 unit normals.
    Index count = 0;
    /// Share of spikes among the neighbours of spikes, over that among all vertices: 0.8 to 1.6 for
    /// spikes, which know nothing of one another, and 2.6 or more for creases and details.
    double clustering = 0.0;

    double share() const { return double(count) / double(height.size()); }
};

/// Finds the vertices that a spike explains best, the largest first, by the matched filter L^T of
/// the residual L X along the normals; then all their heights at once, in the sense of least
/// squares. Vertices that have more such neighbours on their own side of the surface than on the
/// other, by two, are left out: creases and details.
///
/// @param X           n x 3 positions.
/// @param deviations  of the matched filter's output, robustly: smaller ones are no spikes.
/// @param mayMove     n; other vertices are none.
Spikes findSpikes(const FaceGraph& graph, const Points& X, const std::vector<bool>& mayMove,
                  double deviations, double meanEdge);

/// The spikes higher than one and a half edges that explain as good as all of the residual around
/// them, as no tip or corner of a shape does: for where there are too few for statistics.
Spikes certainSpikes(const FaceGraph& graph, const Points& X, Spikes spikes, double meanEdge);

}  // namespace spectral
