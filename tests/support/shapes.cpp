#include "support/shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "core/mesh/mesh.h"

namespace spectral::testing {

namespace {

/// Merges corners that coincide; `tolerance` is far below any edge.
Mesh welded(const Mesh& soup) {
    constexpr double kTolerance = 1e-9;
    std::map<std::array<long long, 3>, int> seen;
    std::vector<int> index(static_cast<std::size_t>(soup.V.rows()));
    std::vector<Index> first;
    for (Index i = 0; i < soup.V.rows(); ++i) {
        std::array<long long, 3> key;
        for (int c = 0; c < 3; ++c) key[c] = std::llround(soup.V(i, c) / kTolerance);
        const auto [entry, isNew] = seen.emplace(key, static_cast<int>(first.size()));
        if (isNew) first.push_back(i);
        index[i] = entry->second;
    }
    Mesh mesh{Vertices(static_cast<Index>(first.size()), 3), soup.F};
    for (std::size_t i = 0; i < first.size(); ++i) mesh.V.row(i) = soup.V.row(first[i]);
    mesh.F = soup.F.unaryExpr([&](int i) { return index[i]; });
    return mesh;
}

}  // namespace

Mesh icosphere(int levels) {
    const double t = (1.0 + std::sqrt(5.0)) / 2.0;
    std::vector<Eigen::RowVector3d> V{{-1, t, 0}, {1, t, 0}, {-1, -t, 0}, {1, -t, 0},
                                      {0, -1, t}, {0, 1, t}, {0, -1, -t}, {0, 1, -t},
                                      {t, 0, -1}, {t, 0, 1}, {-t, 0, -1}, {-t, 0, 1}};
    std::vector<std::array<int, 3>> F{{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                      {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                      {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                      {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    for (auto& v : V) v.normalize();
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<int, int>, int> middle;
        const auto midpoint = [&](int i, int j) {
            const auto [entry, isNew] =
                middle.emplace(std::minmax(i, j), static_cast<int>(V.size()));
            if (isNew) V.push_back((V[i] + V[j]).normalized());
            return entry->second;
        };
        std::vector<std::array<int, 3>> split;
        for (const auto& [a, b, c] : F) {
            const int ab = midpoint(a, b), bc = midpoint(b, c), ca = midpoint(c, a);
            split.insert(split.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
        }
        F = std::move(split);
    }
    Mesh mesh{Vertices(static_cast<Index>(V.size()), 3), Faces(static_cast<Index>(F.size()), 3)};
    for (std::size_t i = 0; i < V.size(); ++i) mesh.V.row(i) = V[i];
    for (std::size_t t2 = 0; t2 < F.size(); ++t2) mesh.F.row(t2) << F[t2][0], F[t2][1], F[t2][2];
    return mesh;
}

Mesh rectangle(double width, double height, int nx, int ny) {
    Mesh mesh{Vertices((nx + 1) * (ny + 1), 3), Faces(2 * nx * ny, 3)};
    const auto at = [&](int i, int j) { return i * (ny + 1) + j; };
    for (int i = 0; i <= nx; ++i)
        for (int j = 0; j <= ny; ++j) mesh.V.row(at(i, j)) << width * i / nx, height * j / ny, 0.0;
    Index t = 0;
    for (int i = 0; i < nx; ++i)
        for (int j = 0; j < ny; ++j) {
            mesh.F.row(t++) << at(i, j), at(i + 1, j), at(i + 1, j + 1);
            mesh.F.row(t++) << at(i, j), at(i + 1, j + 1), at(i, j + 1);
        }
    return mesh;
}

Mesh hemisphere(int rings) {
    const double turn = 2.0 * std::acos(-1.0);
    Mesh mesh{Vertices(1 + 3 * rings * (rings + 1), 3), Faces(6 * rings * rings, 3)};
    const auto at = [](int ring, int i) {
        return ring == 0 ? 0 : 1 + 3 * ring * (ring - 1) + i % (6 * ring);
    };
    mesh.V.row(0) << 0.0, 0.0, 1.0;
    Index t = 0;
    for (int ring = 1; ring <= rings; ++ring) {
        const double polar = 0.25 * turn * ring / rings;
        for (int i = 0; i < 6 * ring; ++i) {
            const double around = turn * i / (6 * ring);
            mesh.V.row(at(ring, i)) << std::sin(polar) * std::cos(around),
                std::sin(polar) * std::sin(around), std::cos(polar);
        }
        for (int sector = 0; sector < 6; ++sector)
            for (int i = 0; i < ring; ++i) {
                const int outer = sector * ring + i, inner = sector * (ring - 1) + i;
                mesh.F.row(t++) << at(ring, outer), at(ring, outer + 1), at(ring - 1, inner);
                if (i + 1 < ring)
                    mesh.F.row(t++) << at(ring, outer + 1), at(ring - 1, inner + 1),
                        at(ring - 1, inner);
            }
    }
    return mesh;
}

Mesh cube(int cells) {
    const Mesh side = rectangle(2.0, 2.0, cells, cells);
    Mesh soup{Vertices(0, 3), Faces(0, 3)};
    for (int axis = 0; axis < 3; ++axis)
        for (const int sign : {-1, 1}) {
            Mesh face = side;
            for (Index i = 0; i < side.V.rows(); ++i) {
                face.V(i, axis) = sign;
                face.V(i, (axis + 1) % 3) = side.V(i, 0) - 1.0;
                face.V(i, (axis + 2) % 3) = side.V(i, 1) - 1.0;
            }
            if (sign < 0) face.F.col(1).swap(face.F.col(2));
            soup = joined(soup, face);
        }
    return welded(soup);
}

Mesh segmentedBall(int radius) {
    const auto isInside = [radius](const Eigen::RowVector3d& p) {
        const double hole = 0.4 * radius;
        return p.norm() < radius - 0.5 && (p - Eigen::RowVector3d(hole, 0, 0)).norm() > hole;
    };
    std::vector<Eigen::RowVector3d> corners;  // triangle by triangle
    const auto addTetrahedron = [&](std::array<Eigen::RowVector3d, 4> p) {
        const auto inside = std::stable_partition(p.begin(), p.end(), isInside) - p.begin();
        const auto middle = [&p](int i, int j) { return (0.5 * (p[i] + p[j])).eval(); };
        if (inside == 1) corners.insert(corners.end(), {middle(0, 1), middle(0, 2), middle(0, 3)});
        if (inside == 3) corners.insert(corners.end(), {middle(0, 3), middle(1, 3), middle(2, 3)});
        if (inside == 2)
            corners.insert(corners.end(), {middle(0, 2), middle(0, 3), middle(1, 2),  //
                                           middle(0, 3), middle(1, 3), middle(1, 2)});
    };
    // Six tetrahedra for each cube, along the paths from one end of its diagonal to the other.
    for (int x = -radius; x < radius; ++x)
        for (int y = -radius; y < radius; ++y)
            for (int z = -radius; z < radius; ++z) {
                std::array<int, 3> axes = {0, 1, 2};
                do {
                    std::array<Eigen::RowVector3d, 4> p;
                    p[0] << x, y, z;
                    for (int k = 0; k < 3; ++k) p[k + 1] = p[k] + Eigen::RowVector3d::Unit(axes[k]);
                    addTetrahedron(p);
                } while (std::next_permutation(axes.begin(), axes.end()));
            }
    Mesh soup{Vertices(corners.size(), 3), Faces(corners.size() / 3, 3)};
    for (Index i = 0; i < soup.V.rows(); ++i) {
        soup.V.row(i) = corners[i];
        soup.F(i / 3, i % 3) = static_cast<int>(i);
    }
    return welded(soup);
}

Mesh torus(double major, double minor, int n, int m) {
    Mesh mesh{Vertices(n * m, 3), Faces(2 * n * m, 3)};
    const double turn = 2.0 * std::acos(-1.0);
    const auto at = [&](int i, int j) { return (i % n) * m + j % m; };
    Index t = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < m; ++j) {
            const double u = turn * i / n, v = turn * j / m, r = major + minor * std::cos(v);
            mesh.V.row(at(i, j)) << r * std::cos(u), r * std::sin(u), minor * std::sin(v);
            mesh.F.row(t++) << at(i, j), at(i + 1, j), at(i + 1, j + 1);
            mesh.F.row(t++) << at(i, j), at(i + 1, j + 1), at(i, j + 1);
        }
    return mesh;
}

Mesh joined(const Mesh& a, const Mesh& b) {
    Mesh mesh{Vertices(a.V.rows() + b.V.rows(), 3), Faces(a.F.rows() + b.F.rows(), 3)};
    mesh.V << a.V, b.V;
    mesh.F << a.F, (b.F.array() + static_cast<int>(a.V.rows())).matrix();
    return mesh;
}

Mesh withNoise(Mesh mesh, double amplitude, unsigned seed) {
    std::mt19937 generator(seed);
    // Not std::uniform_real_distribution: its numbers differ between standard libraries.
    const auto uniform = [&] {
        return 2.0 * (static_cast<double>(generator()) / 4294967296.0) - 1.0;
    };
    for (Index i = 0; i < mesh.V.rows(); ++i)
        for (int c = 0; c < 3; ++c) mesh.V(i, c) += amplitude * uniform();
    return mesh;
}

Mesh blob() {
    Mesh mesh = icosphere(3);
    for (Index i = 0; i < mesh.V.rows(); ++i) {
        const Eigen::RowVector3d p = mesh.V.row(i);
        const double bumps = 1.0 + 0.15 * std::sin(5.0 * p[0] + 1.0) * std::cos(4.0 * p[1]) +
                             0.1 * std::sin(7.0 * p[2] + 3.0 * p[0]);
        mesh.V.row(i) << 1.0 * bumps * p[0], 0.8 * bumps * p[1], 1.3 * bumps * p[2];
    }
    return withNoise(mesh, 0.01, 7);
}

std::vector<Mesh> classesOfMeshes() {
    return {blob(), withNoise(rectangle(2, 1, 20, 10), 0.03, 3),
            joined(blob(), withNoise(cube(5), 0.05, 4))};
}

double largestDifference(const Vertices& A, const Vertices& B) {
    return (A - B).rowwise().norm().maxCoeff();
}

}  // namespace spectral::testing
