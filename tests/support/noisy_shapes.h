#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <vector>

#include "core/graph/face_graph.h"
#include "core/mesh/measures.h"
#include "support/shapes.h"

namespace spectral::testing {

/// Independent samples of the standard normal distribution.
inline Eigen::VectorXd whiteNoise(Index count, unsigned seed = 1) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    return Eigen::VectorXd::NullaryExpr(count, [&] { return normal(random); });
}

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

/// The faces between voxels inside and outside of a ball of a radius in voxels.
inline Mesh voxelFaces(int radius, const Eigen::RowVector3d& size) {
    std::map<std::array<int, 3>, int> corners;
    std::vector<Eigen::RowVector3i> triangles;
    const auto isInside = [&](const std::array<int, 3>& v) {
        return v[0] * v[0] + v[1] * v[1] + v[2] * v[2] < radius * radius;
    };
    const auto corner = [&](std::array<int, 3> at, int axis, int i, int j) {
        ++at[axis];  // on the far side of the voxel
        at[(axis + 1) % 3] += i;
        at[(axis + 2) % 3] += j;
        return corners.emplace(at, static_cast<int>(corners.size())).first->second;
    };
    for (int x = -radius - 1; x <= radius; ++x)
        for (int y = -radius - 1; y <= radius; ++y)
            for (int z = -radius - 1; z <= radius; ++z)
                for (int axis = 0; axis < 3; ++axis) {
                    const std::array<int, 3> here{x, y, z};
                    std::array<int, 3> next = here;
                    ++next[axis];
                    if (isInside(here) == isInside(next)) continue;
                    const int a = corner(here, axis, 0, 0), b = corner(here, axis, 1, 0),
                              c = corner(here, axis, 1, 1), d = corner(here, axis, 0, 1);
                    triangles.emplace_back(a, b, c);
                    triangles.emplace_back(a, c, d);
                }
    Mesh mesh{Vertices(static_cast<Index>(corners.size()), 3),
              Faces(static_cast<Index>(triangles.size()), 3)};
    for (const auto& [at, i] : corners)
        for (int c = 0; c < 3; ++c) mesh.V(i, c) = at[c] * size[c];
    for (std::size_t t = 0; t < triangles.size(); ++t)
        mesh.F.row(static_cast<Index>(t)) = triangles[t];
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
