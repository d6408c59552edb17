#pragma once

#include <vector>

#include "core/graph/face_graph.h"

namespace spectral {

/// Single vertices far off the surface along its normals.
struct Spikes {
    Eigen::VectorXd height;  ///< n: height along N, length units; 0 where there is no spike.
    Points N;                ///< n x 3 unit normals.
    Index count = 0;         ///< Number of spikes.

    double share() const { return double(count) / double(height.size()); }
};

/// Finds spikes, the largest first, by applying the matched filter L^T to the residual L X along
/// the normals; then fits all their heights at once by least squares. Vertices with at least two
/// more neighbouring spikes on their own side of the surface than on the other are left out: these
/// are creases and details.
///
/// @param X           n x 3 positions.
/// @param mayMove     n: whether a vertex can be a spike.
/// @param deviations  smallest output of the matched filter for a spike, in robust standard
///                    deviations.
Spikes findSpikes(const FaceGraph& graph, const Points& X, const std::vector<bool>& mayMove,
                  double deviations, double meanEdge);

/// The spikes higher than one and a half edges that explain nearly all of the residual around them,
/// which no tip or corner of a shape does. For use when there are too few for statistics.
Spikes certainSpikes(const FaceGraph& graph, const Points& X, Spikes spikes, double meanEdge);

}  // namespace spectral
