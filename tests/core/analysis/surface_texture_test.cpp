#include "core/analysis/surface_texture.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <functional>
#include <string>

#include "core/mesh/mesh.h"
#include "core/support/errors.h"
#include "core/support/types.h"
#include "support/shapes.h"

namespace spectral {
namespace {

using testing::cube;
using testing::icosphere;
using testing::Mesh;
using testing::rectangle;

TextureOptions withWaviness(double waviness) {
    TextureOptions options;
    options.waviness = waviness;
    return options;
}

SurfaceTexture measured(const Mesh& mesh, const TextureOptions& options) {
    return surfaceTexture(mesh.V, mesh.F, options);
}

/// A plane with the height z(x, y).
Mesh plane(double size, int cells, const std::function<double(double, double)>& z) {
    Mesh mesh = rectangle(size, size, cells, cells);
    for (Index i = 0; i < mesh.V.rows(); ++i) mesh.V(i, 2) = z(mesh.V(i, 0), mesh.V(i, 1));
    return mesh;
}

/// An open cylinder along z, of the radius r(u, z) at u = radius * angle.
Mesh cylinder(double radius, double height, int around, int along,
              const std::function<double(double, double)>& r) {
    Mesh mesh;
    mesh.V.resize(Index{around} * (along + 1), 3);
    mesh.F.resize(2 * Index{around} * along, 3);
    for (int i = 0; i < around; ++i)
        for (int j = 0; j <= along; ++j) {
            const double angle = 2.0 * kPi * i / around, z = height * j / along;
            const double distance = r(radius * angle, z);
            mesh.V.row(Index{i} * (along + 1) + j) << distance * std::cos(angle),
                distance * std::sin(angle), z;
        }
    Index t = 0;
    for (int i = 0; i < around; ++i)
        for (int j = 0; j < along; ++j) {
            const int a = i * (along + 1) + j, b = (i + 1) % around * (along + 1) + j;
            mesh.F.row(t++) << a, b, b + 1;
            mesh.F.row(t++) << a, b + 1, a + 1;
        }
    return mesh;
}

/// Oblique waves: their crests meet the vertices at all phases.
std::function<double(double)> waveOf(double amplitude, double length) {
    return [=](double along) { return amplitude * std::cos(2.0 * kPi * along / length); };
}

/// Amplitude of a wave in the evaluated heights: its least-squares fit.
double amplitudeOf(const Eigen::VectorXd& height, const Eigen::VectorXd& phase) {
    Eigen::Matrix2d A = Eigen::Matrix2d::Zero();
    Eigen::Vector2d b = Eigen::Vector2d::Zero();
    for (Index i = 0; i < height.size(); ++i) {
        if (height[i] == 0.0) continue;
        const Eigen::Vector2d basis(std::cos(phase[i]), std::sin(phase[i]));
        A += basis * basis.transpose();
        b += height[i] * basis;
    }
    return A.ldlt().solve(b).norm();
}

TEST(SurfaceTexture, TransmitsWavesOnAPlaneAsTheStandardsGaussian) {
    constexpr double a = 0.002;
    for (const double length : {0.25, 0.5, 1.0, 2.0, 4.0}) {
        const auto wave = waveOf(a, length);
        const Mesh mesh =
            plane(8.0, 192, [&](double x, double y) { return wave(0.8 * x + 0.6 * y); });
        const Eigen::VectorXd phase =
            2.0 * kPi / length * (0.8 * mesh.V.col(0) + 0.6 * mesh.V.col(1));
        const double rough = amplitudeOf(measured(mesh, withWaviness(1.0)).height, phase) / a;
        EXPECT_NEAR(rough, 1.0 - std::exp2(-std::pow(1.0 / length, 2)), 0.01) << length;
        if (length > 2.0) continue;
        TextureOptions options = withWaviness(2.0);
        options.noise = 1.0;
        const double kept = amplitudeOf(measured(mesh, options).height, phase) / a;
        EXPECT_NEAR(kept,
                    std::exp2(-std::pow(1.0 / length, 2)) - std::exp2(-std::pow(2.0 / length, 2)),
                    0.01)
            << length;
    }
}

/// Of heights above a fitted shape, as the standard's Gaussian leaves them.
double rough(double cutoff, double length) {
    return 1.0 - std::exp2(-std::pow(cutoff / length, 2));
}

TextureOptions above(FormKind form, double waviness) {
    TextureOptions options = withWaviness(waviness);
    options.form = form;
    return options;
}

TEST(SurfaceTexture, TransmitsWavesAboveFittedShapesAsTheStandardSays) {
    constexpr double a = 0.002, cutoff = 1.0;
    const double radius = 32.0 / (2.0 * kPi);
    for (const double length : {0.5, 1.0, 2.0}) {
        const auto wave = waveOf(a, length);
        // As coarse as eight edges a cutoff: what the mesh does to wavelengths is allowed for.
        const Mesh flat =
            plane(8.0, 64, [&](double x, double y) { return wave(0.8 * x + 0.6 * y); });
        const Eigen::VectorXd across =
            2.0 * kPi / length * (0.8 * flat.V.col(0) + 0.6 * flat.V.col(1));
        EXPECT_NEAR(amplitudeOf(measured(flat, above(FormKind::Plane, cutoff)).height, across) / a,
                    rough(cutoff, length), 0.005)
            << length;
        const Mesh round =
            cylinder(radius, 8.0, 480, 120, [&](double u, double) { return radius + wave(u); });
        Eigen::VectorXd around(round.V.rows());
        for (Index i = 0; i < around.size(); ++i)
            around[i] = std::atan2(round.V(i, 1), round.V(i, 0)) * radius * 2.0 * kPi / length;
        EXPECT_NEAR(
            amplitudeOf(measured(round, above(FormKind::Cylinder, cutoff)).height, around) / a,
            rough(cutoff, length), 0.005)
            << length;
    }
    for (const int l : {4, 8, 16}) {
        // A zonal harmonic, of the wavelength 2 pi / (l (l + 1))^(1/2).
        Mesh ball = icosphere(5);
        Eigen::VectorXd zonal(ball.V.rows());
        for (Index i = 0; i < zonal.size(); ++i) zonal[i] = std::legendre(l, ball.V(i, 2));
        ball.V = (1.0 + a * zonal.array()).matrix().asDiagonal() * ball.V;
        const double size = 2.0 * kPi / std::sqrt(8.0 * 9.0);
        const SurfaceTexture texture = measured(ball, above(FormKind::Sphere, size));
        EXPECT_NEAR(texture.height.dot(zonal) / zonal.squaredNorm() / a,
                    rough(size, 2.0 * kPi / std::sqrt(l * (l + 1.0))), 0.005)
            << l;
    }
}

TEST(SurfaceTexture, AboveAFittedShapeDoesNotDependOnTheSlope) {
    for (const double a : {0.002, 0.02, 0.04, 0.1}) {
        const auto wave = waveOf(a, 0.4);
        const Mesh mesh = plane(4.0, 160, [&](double x, double) { return wave(x); });
        const double kept = a * rough(0.8, 0.4);
        // The rms slope is 1.1 at the last amplitude.
        for (const FormKind form : {FormKind::Plane, FormKind::Size}) {
            if (form == FormKind::Size && a > 0.05) continue;  // up to a slope of .5
            const SurfaceTexture texture = measured(mesh, above(form, 0.8));
            EXPECT_NEAR(texture.Sq, kept / std::sqrt(2.0), 0.02 * kept / std::sqrt(2.0)) << a;
            EXPECT_NEAR(texture.Sz, 2.0 * kept, 0.04 * kept) << a << " " << static_cast<int>(form);
        }
    }
}

/// A mesh without the triangles at some vertices.
Mesh without(Mesh mesh, const std::function<bool(Index)>& missing) {
    Index kept = 0;
    for (Index t = 0; t < mesh.F.rows(); ++t) {
        const auto corners = mesh.F.row(t);
        if (missing(corners[0]) || missing(corners[1]) || missing(corners[2])) continue;
        mesh.F.row(kept++) = corners;
    }
    mesh.F.conservativeResize(kept, 3);
    return mesh;
}

TEST(SurfaceTexture, MissingPointsLeaveNothingOutButThemselves) {
    const auto wave = waveOf(0.01, 1.0);
    const Mesh whole =
        plane(12.0, 120, [&](double x, double y) { return wave(0.8 * x + 0.6 * y); });
    // Single points, and squares of a fifth of a cutoff.
    const Mesh holes = without(whole, [](Index i) {
        const Index x = i / 121, y = i % 121;
        return (i * 7919) % 1009 == 0 || (x % 40 < 2 && y % 40 < 2 && x > 5 && y > 5);
    });
    for (const FormKind form : {FormKind::Plane, FormKind::Size}) {
        const SurfaceTexture all = measured(whole, above(form, 2.0));
        const SurfaceTexture most = measured(holes, above(form, 2.0));
        EXPECT_GT(most.evaluated, 0.97 * all.evaluated);
        EXPECT_NEAR(most.Sq, all.Sq, 0.01 * all.Sq);
        EXPECT_NEAR(most.Sz, all.Sz, 0.05 * all.Sz);
    }
    // A hole of a cutoff is an end, and so is the rim of a tube of any width.
    const Mesh window = without(
        whole, [](Index i) { return std::abs(i / 121 - 60) < 6 && std::abs(i % 121 - 60) < 6; });
    EXPECT_LT(measured(window, above(FormKind::Plane, 2.0)).evaluated,
              0.8 * measured(whole, above(FormKind::Plane, 2.0)).evaluated);
    const Mesh tube = cylinder(0.2, 8.0, 24, 160, [](double, double) { return 0.2; });
    EXPECT_GT(measured(tube, above(FormKind::Cylinder, 1.0)).leftOut, 24 * 40);
}

TEST(SurfaceTexture, ARoughHalfIsNoCrease) {
    const Mesh mesh = plane(6.0, 150, [](double x, double y) {
        return x < 3.0 ? 0.0 : 0.03 * std::cos(2.0 * kPi * x / 0.2) * std::cos(2.0 * kPi * y / 0.2);
    });
    for (const FormKind form : {FormKind::Plane, FormKind::Size}) {
        const SurfaceTexture texture = measured(mesh, above(form, 0.8));
        TextureOptions all = above(form, 0.8);
        all.creaseAngle = 180.0;
        EXPECT_EQ(texture.evaluated, measured(mesh, all).evaluated);
        EXPECT_NEAR(texture.Sq, 0.5 * 0.03 / std::sqrt(2.0), 0.02 * 0.03);
    }
}

/// A closed cylinder: caps of rings around a vertex on the axis.
Mesh capped(const Mesh& tube, int around, int along, double radius, double height) {
    Mesh mesh = tube;
    constexpr int kRings = 8;
    for (const double z : {0.0, height}) {
        const auto first = static_cast<int>(mesh.V.rows());
        mesh.V.conservativeResize(first + kRings * around, 3);
        const auto at = [&](int ring, int i) {
            return ring == 0 ? i % around * (along + 1) + (z > 0.0 ? along : 0)
                             : first + (ring - 1) * around + i % around;
        };
        for (int ring = 1; ring <= kRings; ++ring)
            for (int i = 0; i < around; ++i) {
                const double r = radius * (1.0 - ring / (kRings + 0.5));
                const double angle = 2.0 * kPi * i / around;
                mesh.V.row(at(ring, i)) << r * std::cos(angle), r * std::sin(angle), z;
            }
        Index t = mesh.F.rows();
        mesh.F.conservativeResize(t + 2 * kRings * around, 3);
        for (int ring = 0; ring < kRings; ++ring)
            for (int i = 0; i < around; ++i) {
                const int a = at(ring, i), b = at(ring, i + 1), c = at(ring + 1, i + 1),
                          d = at(ring + 1, i);
                if (z > 0.0) {
                    mesh.F.row(t++) << a, b, c;
                    mesh.F.row(t++) << a, c, d;
                } else {
                    mesh.F.row(t++) << a, c, b;
                    mesh.F.row(t++) << a, d, c;
                }
            }
    }
    return mesh;
}

TEST(SurfaceTexture, CapsAreNotPartOfACylinder) {
    const auto wave = waveOf(0.01, 0.5);
    for (const double height : {8.0, 2.0}) {
        const int along = static_cast<int>(24 * height);
        const Mesh tube =
            cylinder(1.0, height, 144, along, [&](double, double z) { return 1.0 + wave(z); });
        const SurfaceTexture open = measured(tube, above(FormKind::Cylinder, 0.5));
        const SurfaceTexture closed =
            measured(capped(tube, 144, along, 1.0, height), above(FormKind::Cylinder, 0.5));
        EXPECT_NEAR(open.Sz, 0.01, 0.0002);
        EXPECT_NEAR(closed.Sz, open.Sz, 0.01 * open.Sz);
        EXPECT_NEAR(closed.Sq, open.Sq, 0.01 * open.Sq);
        EXPECT_NEAR(closed.formRadius, open.formRadius, 1e-3);
        EXPECT_NEAR(closed.evaluated, open.evaluated, 0.01 * open.evaluated);
    }
}

TEST(SurfaceTexture, RefusesWhatHasTwoSidesOrTwoUnits) {
    EXPECT_THROW(measured(cube(12), above(FormKind::Plane, 0.2)), InvalidOption);
    const Mesh micrometres = plane(
        5.0, 60, [](double x, double y) { return 4.0 * std::cos(9.0 * x) * std::cos(9.0 * y); });
    for (const FormKind form : {FormKind::Plane, FormKind::Size}) try {
            measured(micrometres, above(form, 0.8));
            FAIL();
        } catch (const InvalidOption& error) {
            EXPECT_NE(std::string(error.what()).find("divide z by 1000"), std::string::npos);
        }
}

}  // namespace
}  // namespace spectral
