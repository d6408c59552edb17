#include "fuzz/meshes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "core/mesh/measures.h"
#include "core/support/types.h"
#include "support/shapes.h"

namespace spectral::fuzz {

namespace {

using testing::Mesh;

/// A wheel, or with two hubs a double cone: vertices of high valence.
Mesh fan(int rim, bool isClosed, double height) {
    const int hubs = isClosed ? 2 : 1;
    Mesh mesh{Vertices(rim + hubs, 3), Faces(rim * hubs, 3)};
    for (int i = 0; i < rim; ++i) {
        const double angle = 2.0 * kPi * i / rim;
        mesh.V.row(i) << std::cos(angle), std::sin(angle), 0.0;
        mesh.F.row(i) << i, (i + 1) % rim, rim;
        if (isClosed) mesh.F.row(rim + i) << (i + 1) % rim, i, rim + 1;
    }
    for (int h = 0; h < hubs; ++h) mesh.V.row(rim + h) << 0.0, 0.0, h == 0 ? height : -height;
    return mesh;
}

/// Random triangles between random points; a triangle may repeat a vertex.
Mesh soup(Choices& choices, int most) {
    const int n = choices.between(3, std::min(40, most));
    const int m = choices.between(1, std::min(80, 2 * most));
    Mesh mesh{Vertices::Zero(n, 3), Faces(m, 3)};
    mesh = testing::withNoise(mesh, 1.0, choices.bits(4));
    for (Index t = 0; t < m; ++t)
        for (int c = 0; c < 3; ++c) mesh.F(t, c) = choices.below(n);
    return mesh;
}

Mesh triangle() {
    Mesh mesh{Vertices(3, 3), Faces(1, 3)};
    mesh.V << 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.3, 0.8, 0.0;
    mesh.F << 0, 1, 2;
    return mesh;
}

Mesh tetrahedron() { return fan(3, false, 1.2); }

/// Tiny components far from one another.
Mesh crumbs(Choices& choices, int most) {
    const int count = choices.between(2, std::clamp(most / 6, 2, 30));
    const double distance = choices.logUniform(1e7, 1e16);
    Mesh mesh;
    for (int i = 0; i < count; ++i) {
        Mesh crumb = choices.pick<int>({0, 1, 2}) == 0 ? testing::icosphere(0)
                     : choices.oneIn(2)                ? tetrahedron()
                                                       : triangle();
        for (int c = 0; c < 3; ++c) crumb.V.col(c).array() += distance * choices.uniform(-1.0, 1.0);
        mesh = i == 0 ? crumb : testing::joined(mesh, crumb);
    }
    return mesh;
}

/// A shape of about unit size, and its name.
/// @param most  approximate upper bound of the number of vertices, >= 4.
NamedMesh baseShape(Choices& choices, int most) {
    const int side = static_cast<int>(std::sqrt(most));
    switch (choices.below(13)) {
        case 0:
        case 1:
            return {testing::icosphere(std::min(choices.pick({0, 1, 1, 2}), most < 42    ? 0
                                                                            : most < 162 ? 1
                                                                                         : 2)),
                    "sphere"};
        case 2: {
            const int longest = std::clamp(side, 3, 14), n = choices.between(3, longest);
            return {
                testing::torus(1.0, choices.logUniform(0.01, 0.9), n, choices.between(3, longest)),
                "torus"};
        }
        case 3: return {testing::cube(choices.between(1, std::clamp(side / 3, 1, 5))), "box"};
        case 4: {
            const int longest = std::clamp(side - 1, 1, 14), nx = choices.between(1, longest);
            return {testing::rectangle(1.0, choices.logUniform(0.05, 1.0), nx,
                                       choices.between(1, longest)),
                    "grid"};
        }
        case 5:
            return {testing::hemisphere(choices.between(1, std::clamp(side / 2, 1, 7))),
                    "hemisphere"};
        case 6:
            if (most < 100) return {testing::cube(1), "box"};
            return {testing::segmentedBall(choices.between(2, 3)), "voxels"};
        case 7: return {triangle(), "triangle"};
        case 8: {
            const int rim = std::min(choices.pick({3, 5, 17, 60, 250}), most);
            const bool isClosed = choices.oneIn(2);
            return {fan(rim, isClosed, choices.pick({0.0, 1e-4, 1.0, 30.0})),
                    isClosed ? "double cone" : "wheel"};
        }
        case 9: return {soup(choices, most), "soup"};
        case 10: return {crumbs(choices, most), "crumbs"};
        case 11:
            return {testing::rectangle(1.0, choices.logUniform(1e-9, 1e-2),
                                       choices.between(2, std::clamp(most / 2, 2, 40)),
                                       choices.between(1, 2)),
                    "ribbon"};
        default:
            if (most < 300) return {tetrahedron(), "wheel"};
            // Too many vertices for the dense solver of the core.
            switch (choices.below(3)) {
                case 0: return {testing::torus(1.0, 0.4, 19, choices.between(16, 20)), "torus"};
                case 1: return {testing::cube(8), "box"};
                default: return {testing::rectangle(1.0, 0.8, 18, choices.between(16, 20)), "grid"};
            }
    }
}

int anyVertex(Choices& choices, const Mesh& mesh) {
    return choices.below(static_cast<int>(mesh.V.rows()));
}
int anyFace(Choices& choices, const Mesh& mesh) {
    return choices.below(static_cast<int>(mesh.F.rows()));
}

void addVertex(Mesh& mesh, const Eigen::RowVector3d& at) {
    mesh.V.conservativeResize(mesh.V.rows() + 1, Eigen::NoChange);
    mesh.V.bottomRows(1) = at;
}

void addFace(Mesh& mesh, int a, int b, int c) {
    mesh.F.conservativeResize(mesh.F.rows() + 1, Eigen::NoChange);
    mesh.F.bottomRows(1) << a, b, c;
}

/// One change to a mesh with triangles; returns its name.
std::string change(Choices& choices, Mesh& mesh, int most) {
    const int i = anyVertex(choices, mesh), j = anyVertex(choices, mesh);
    const int t = anyFace(choices, mesh), count = choices.between(1, 6);
    switch (choices.below(17)) {
        case 0: {
            const double length = choices.logUniform(10.0, 1e7);
            mesh.V.row(i) *= length;
            std::ostringstream name;
            name.precision(2);
            name << "spike of " << length;
            return name.str();
        }
        case 1: mesh.V.row(mesh.F(t, 0)) = mesh.V.row(mesh.F(t, 1)); return "collapsed edge";
        case 2: {
            const double share = choices.logUniform(1e-15, 1e-3);
            const int a = mesh.F(t, 0), b = mesh.F(t, 1);
            mesh.V.row(a) = (1.0 - share) * mesh.V.row(b) + share * mesh.V.row(a);
            return "short edge";
        }
        case 3:
            mesh.V.row(mesh.F(t, 0)) = 0.5 * (mesh.V.row(mesh.F(t, 1)) + mesh.V.row(mesh.F(t, 2)));
            return "flat triangle";
        case 4:
            for (int k = 0; k < count; ++k) {
                const int f = anyFace(choices, mesh);
                if (choices.oneIn(2))
                    addFace(mesh, mesh.F(f, 0), mesh.F(f, 1), mesh.F(f, 2));
                else
                    addFace(mesh, mesh.F(f, 1), mesh.F(f, 0), mesh.F(f, 2));
            }
            return "duplicate faces";
        case 5:
            for (int k = 0; k < count; ++k) {
                const int f = anyFace(choices, mesh), c = choices.below(3);
                addVertex(mesh, mesh.V.row(mesh.F(f, c)));
                mesh.F(f, c) = static_cast<int>(mesh.V.rows()) - 1;
            }
            return "duplicate vertices";
        case 6:
            for (int k = 0; k < count && mesh.F.rows() > 1; ++k) {
                mesh.F.row(anyFace(choices, mesh)) = mesh.F.bottomRows(1).eval();
                mesh.F.conservativeResize(mesh.F.rows() - 1, Eigen::NoChange);
            }
            return "holes";
        case 7:
            for (int k = 0; k < count; ++k) {
                const int f = anyFace(choices, mesh);
                std::swap(mesh.F(f, 0), mesh.F(f, 1));
            }
            return "flipped faces";
        case 8:
            mesh.F = mesh.F.unaryExpr([i, j](int v) { return v == i ? j : v; }).eval();
            return "welded vertices";
        case 9:
            for (int k = 0; k < count; ++k) {
                addVertex(mesh, mesh.V.row(i) + Eigen::RowVector3d(0.1, 0.2, 0.3 * k));
                addFace(mesh, mesh.F(t, 0), mesh.F(t, 1), static_cast<int>(mesh.V.rows()) - 1);
            }
            return "fins";
        case 10:
            for (int k = 0; k < count; ++k)
                addVertex(mesh, Eigen::RowVector3d(choices.uniform(-1.0, 1.0), k, 0.5));
            return "isolated vertices";
        case 11:
            addVertex(mesh, Eigen::RowVector3d(choices.logUniform(1e3, 1e20), 1.0, -1.0));
            return "stray vertex";
        case 12: mesh.V.col(2) *= choices.pick({0.0, 1e-12, 1e-6}); return "flattened";
        case 13: mesh.V.col(0) *= choices.logUniform(1e-6, 1e6); return "stretched";
        case 14: {
            const double grid = choices.pick({0.5, 0.1, 1e-3, 1e-6});
            mesh.V = (mesh.V / grid).array().round().matrix() * grid;
            return "on a lattice";
        }
        case 15: mesh.V.row(i) = mesh.V.row(j); return "coincident vertices";
        default: {
            Mesh other = baseShape(choices, most).mesh;
            other.V *= choices.logUniform(1e-6, 10.0);
            other.V.col(0).array() += choices.pick({0.0, 2.5, 100.0});
            if (mesh.V.rows() + other.V.rows() < 350) mesh = testing::joined(mesh, other);
            return "second component";
        }
    }
}

/// Damages a mesh so that the core must reject it.
std::string spoil(Choices& choices, Mesh& mesh) {
    switch (choices.below(6)) {
        case 0:
            mesh.V(anyVertex(choices, mesh), choices.below(3)) =
                std::numeric_limits<double>::quiet_NaN();
            return "NaN";
        case 1:
            mesh.V(anyVertex(choices, mesh), choices.below(3)) =
                -std::numeric_limits<double>::infinity();
            return "infinity";
        case 2: mesh.F(anyFace(choices, mesh), 1) = static_cast<int>(mesh.V.rows()); return "index";
        case 3: mesh.F(anyFace(choices, mesh), 2) = -1; return "negative index";
        case 4: mesh.F.resize(0, 3); return "no faces";
        default:
            mesh.V.resize(0, 3);
            mesh.F.resize(0, 3);
            return "empty";
    }
}

/// A strip, tube or arc of long cells, turned at random, in most cases rounded as files are: the
/// corners of every cell are nearly cocircular, and round-off decides which diagonal is Delaunay.
NamedMesh needles(Choices& choices) {
    const int nx = choices.between(1, 12), ny = choices.between(1, 3);
    const double aspect = choices.logUniform(1e2, 1e9);  // of a cell
    Mesh mesh = testing::rectangle(nx, ny * aspect, nx, ny);
    Vertices& V = mesh.V;
    std::string name = "needles";
    if (choices.oneIn(4)) {
        V.col(0) += choices.uniform(-1.0, 1.0) * V.col(1);
        name += ", sheared";
    }
    if (choices.oneIn(3)) {
        V.col(0) = V.col(0).array().square().eval();
        name += ", of several widths";
    }
    if (choices.oneIn(3)) {
        const double radius = V.col(0).maxCoeff() / choices.uniform(0.1, 2.0 * kPi);
        V.col(2) = radius * (V.col(0) / radius).array().cos();
        V.col(0) = radius * (V.col(0) / radius).array().sin();
        name += ", bent";
    }
    if (choices.oneIn(3)) {
        V = testing::withNoise(mesh, choices.logUniform(1e-9, 1.0), choices.bits(4)).V;
        name += ", with noise";
    }
    Eigen::Vector4d turn;
    for (double& x : turn) x = choices.uniform(-1.0, 1.0);
    V = (V * Eigen::Quaterniond(turn.normalized()).toRotationMatrix()).eval();
    if (!choices.oneIn(3)) {
        V = V.cast<float>().cast<double>().eval();
        name += ", rounded";
    }
    return {mesh, name};
}

}  // namespace

NamedMesh makeMesh(Choices& choices, Sizes sizes) {
    if (sizes == Sizes::Needles) return needles(choices);
    int most = 1000;
    if (sizes == Sizes::MostlySmall)
        most = choices.oneIn(30) ? 300 : static_cast<int>(choices.logUniform(4.0, 60.0));
    NamedMesh made = baseShape(choices, most);
    if (choices.oneIn(400) && most >= 300)
        made = {testing::rectangle(1.0, 0.7, 50, 45), "large grid"};
    Mesh& mesh = made.mesh;
    if (!choices.oneIn(3)) {
        const double noise = choices.pick({0.0, 1e-13, 1e-8, 1e-3, 0.02, 0.1});
        if (noise > 0.0 && made.name != "ribbon") {
            mesh = testing::withNoise(mesh, noise, choices.bits(4));
            made.name += " with noise";
        }
    }
    for (int changes = choices.pick({0, 0, 1, 1, 2, 3}); changes > 0; --changes)
        made.name += ", " + change(choices, mesh, most);
    if (choices.oneIn(5)) {
        const double exponent = choices.uniform(-60.0, 75.0);
        mesh.V *= std::pow(10.0, exponent);
        made.name += ", scaled by 1e" + std::to_string(static_cast<int>(exponent));
    }
    if (choices.oneIn(10)) {
        const double far = choices.logUniform(1.0, 1e7) * boundingBoxDiagonal(mesh.V);
        mesh.V.rowwise() += Eigen::RowVector3d(far, -0.3 * far, 0.1 * far);
        made.name += ", offset";
    }
    if (choices.oneIn(40)) made.name += ", " + spoil(choices, mesh);
    return made;
}

}  // namespace spectral::fuzz
