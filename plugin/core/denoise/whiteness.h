#pragma once

#include <Eigen/Core>

#include "core/graph/face_graph.h"

namespace spectral {

/// The part of a displacement X - X0 (n x 3) along the normals of X, n values.
Eigen::VectorXd displacementAlongNormals(const FaceGraph& graph, const Points& X0, const Points& X);

/// Fraction of the standard deviation of a signal (n values) left by one step of diffusion,
/// relative to that of white noise: 1 for white noise, more for smooth ones such as shapes.
double smoothness(const VertexGraph& graph, const Eigen::VectorXd& signal);

/// Ratio of the 99 % quantile to the standard deviation, relative to that of a normal distribution;
/// the largest after one, two and four steps of diffusion. It is 1 for white noise, more for
/// signals that are large in places.
double tail(const VertexGraph& graph, const Eigen::VectorXd& signal);

}  // namespace spectral
