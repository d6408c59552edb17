#pragma once

#include <optional>
#include <vector>

#include "core/noise/face_graph.h"

namespace spectral {

struct LinearSteps {
    Points X;  ///< n x 3
    int steps = 0;
    Points N;  ///< m x 3
};

/// Removes white noise from a smooth shape: steps of Taubin 1995, X <- (I + 0.61 L)(I - 0.6 L) X,
/// of which the part along the normals is kept, so that the triangles do not drift within the
/// surface.
///
/// As many steps as have the least error of the slopes of edges by Stein's unbiased risk estimate
/// (1981): what the steps take from the shape is what they move more than white noise, what they
/// leave of the noise is what they leave of white noise.
///
/// @param X         n x 3 positions.
/// @param mayMove   n; vertices on rims are averaged along the rim.
/// @param height    of the noise, mean edges.
/// @param isTailed  whether the noise has more large values than a normal distribution.
/// @return  none where few steps are best, the least error is large, or the displacement is large
/// at
///          some places: a filter that keeps creases and details does better there.
std::optional<LinearSteps> linearSteps(const FaceGraph& graph, const Points& X,
                                       const std::vector<bool>& mayMove, double height,
                                       bool isTailed);

}  // namespace spectral
