#pragma once

#include <optional>
#include <vector>

#include "core/graph/face_graph.h"
#include "core/noise/noise_field.h"

namespace spectral {

/// The neighbours each vertex is averaged with: none if it may not move, only those on the rim if
/// it is on the rim itself.
VertexGraph averagedNeighbours(const FaceGraph& graph, const std::vector<bool>& mayMove);

struct LinearSteps {
    Points X;       ///< n x 3 smoothed positions.
    int steps = 0;  ///< Number of steps taken.
    Points N;       ///< m x 3 unit face normals.
};

/// Removes white noise from a smooth shape by Taubin's steps (1995), X <- (I + 0.61 L)(I - 0.6 L)
/// X. Only the displacement along the normals is kept, so that triangles do not drift within the
/// surface.
///
/// Takes as many steps as minimize the error of the edge slopes by Stein's unbiased risk estimate
/// (1981): the damage to the shape is how much more the steps move it than white noise, and the
/// remaining noise is what the steps leave of white noise.
///
/// @param X         n x 3 positions.
/// @param mayMove   n: whether a vertex may move; those on rims are averaged along the rim.
/// @param height    standard deviation of the noise, mean edges.
/// @param isTailed  whether the noise has heavier tails than a normal distribution.
/// @return  none if the least error is large, as when few steps are best, or the displacement is
///          large in places: a filter that preserves creases and details does better there.
std::optional<LinearSteps> linearSteps(const FaceGraph& graph, const Points& X,
                                       const std::vector<bool>& mayMove, double height,
                                       bool isTailed);

/// The same, with as many steps in each place as leave least error there.
struct LinearStepsByPlace {
    Points X;               ///< n x 3 smoothed positions; X where nothing may move.
    int steps = 0;          ///< Largest number of steps taken.
    Eigen::VectorXd share;  ///< n: 1 where the error is small, 0 where a filter that preserves
                            ///< creases and details does better.
    double rejected = 0.0;  ///< Share of the moving vertices where it is below 1.
};

/// @param place     heights and edges at every vertex.
/// @param maxSteps  roughness as fine as the edges would take more.
LinearStepsByPlace linearStepsByPlace(const FaceGraph& graph, const Points& X,
                                      const std::vector<bool>& mayMove, const NoiseField& place,
                                      int maxSteps);

}  // namespace spectral
