#pragma once

#include <Eigen/Core>

#include "core/noise/face_graph.h"

namespace spectral {

/// The part of a displacement X - X0 (n x 3) along the normals of X, n values.
Eigen::VectorXd displacementAlongNormals(const FaceGraph& graph, const Points& X0, const Points& X);

/// How much of a signal (n values) one step of diffusion leaves, by its deviation, over what it
/// leaves of white noise: 1 for white noise, more for what varies slowly, as a shape does.
double smoothness(const VertexGraph& graph, const Eigen::VectorXd& signal);

/// The most, over one, two and four steps of diffusion, of the quantile of 99 % over the deviation,
/// relative to that of white noise: 1 for white noise, more for what is large at some places.
double tail(const VertexGraph& graph, const Eigen::VectorXd& signal);

}  // namespace spectral
