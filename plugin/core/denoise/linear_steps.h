#pragma once

#include <vector>

#include "core/graph/face_graph.h"
#include "core/noise/noise_field.h"

namespace spectral {

/// The neighbours each vertex is averaged with: none if it may not move, only those on the rim if
/// it is on the rim itself.
/// @param means  the neighbours on the surface, and their weights.
VertexGraph averagedNeighbours(const FaceGraph& graph, const VertexGraph& means,
                               const std::vector<bool>& mayMove);

struct LinearSteps {
    Points X;               ///< n x 3 smoothed positions; X where nothing may move.
    Points N;               ///< m x 3 unit face normals of the shape.
    int steps = 0;          ///< Largest number of steps taken.
    Eigen::VectorXd share;  ///< n: 1 where the error is small, 0 where a filter that preserves
                            ///< creases and details does better.
    double rejected = 0.0;  ///< Share of the moving vertices where it is below 1.
};

/// Removes white noise from a smooth shape by Taubin's steps (1995), X <- (I + 0.61 L)(I - 0.6 L)
/// X. Only the displacement along the normals is kept, so that triangles do not drift within the
/// surface.
///
/// Takes, in each place, as many steps as minimize the error of the edge slopes by Stein's unbiased
/// risk estimate (1981): the damage to the shape is how much more the steps move it than white
/// noise, and the remaining noise is what the steps leave of white noise. Both are averages over
/// the place, or over all vertices if the noise is alike everywhere.
///
/// @param means     the neighbours that each vertex is averaged with; those on rims are averaged
///                  along the rim.
/// @param X         n x 3 positions.
/// @param mayMove   n: whether a vertex may move.
/// @param noise     heights and edges at every vertex.
/// @param isTailed  whether the noise has heavier tails than a normal distribution.
LinearSteps linearSteps(const FaceGraph& graph, const VertexGraph& means, const Points& X,
                        const std::vector<bool>& mayMove, const NoiseField& noise, bool isTailed);

}  // namespace spectral
