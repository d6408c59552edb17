#pragma once

#include <algorithm>
#include <cmath>
#include <random>

#include "core/mesh/measures.h"
#include "core/noise/face_graph.h"
#include "support/shapes.h"

namespace spectral::testing {

/// Noise of a standard deviation of `edges` mean edges along every axis, thus along the normals.
inline Mesh withGaussianNoise(Mesh mesh, double edges, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0.0, edges * meanEdgeLength(mesh.V, mesh.F));
    for (Index i = 0; i < mesh.V.rows(); ++i)
        for (int c = 0; c < 3; ++c) mesh.V(i, c) += normal(random);
    return mesh;
}

/// The same, only where z is above a limit.
inline Mesh noisyAbove(Mesh mesh, double z, double edges, unsigned seed) {
    const Mesh noisy = withGaussianNoise(mesh, edges, seed);
    for (Index i = 0; i < mesh.V.rows(); ++i)
        if (mesh.V(i, 2) > z) mesh.V.row(i) = noisy.V.row(i);
    return mesh;
}

/// Displaces vertices of a sphere or another star-shaped surface outwards or inwards, each with a
/// probability, by `edges` mean edges.
inline Mesh withSpikes(Mesh mesh, double probability, double edges, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    const double height = edges * meanEdgeLength(mesh.V, mesh.F);
    for (Index i = 0; i < mesh.V.rows(); ++i) {
        const double chance = uniform(random), sign = uniform(random) < 0.5 ? -1.0 : 1.0;
        if (chance < probability) mesh.V.row(i) += sign * height * mesh.V.row(i).normalized();
    }
    return mesh;
}

/// Mean angle between the normals of two shapes, in degrees.
inline double meanAngle(const Vertices& A, const Vertices& B, const Faces& F) {
    Points M = areaNormals(A, F), N = areaNormals(B, F);
    normalizeRows(M);
    normalizeRows(N);
    double sum = 0.0;
    for (Index t = 0; t < F.rows(); ++t)
        sum += std::acos(std::clamp(M.row(t).dot(N.row(t)), -1.0, 1.0));
    return sum / static_cast<double>(F.rows()) * 180.0 / kPi;
}

inline double meanDistance(const Vertices& A, const Vertices& B) {
    return (A - B).rowwise().norm().mean();
}

inline std::vector<bool> everywhere(Index count) {
    return std::vector<bool>(static_cast<std::size_t>(count), true);
}

}  // namespace spectral::testing
