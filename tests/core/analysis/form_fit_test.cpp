#include "core/analysis/form_fit.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "core/support/errors.h"
#include "core/support/types.h"

namespace spectral {
namespace {

/// Points with their normals, turned and shifted.
struct Points {
    Vertices X, N;
};

constexpr double kTurn = 0.9;
const Eigen::RowVector3d kShift(4.0, -7.0, 2.0);

Eigen::Matrix3d turn() {
    return Eigen::AngleAxisd(kTurn, Eigen::Vector3d(1.0, -2.0, 0.5).normalized())
        .toRotationMatrix();
}

Points placed(Points points) {
    points.X = (points.X * turn().transpose()).eval();
    points.X.rowwise() += kShift;
    points.N = (points.N * turn().transpose()).eval();
    return points;
}

/// A part of a cylinder along z, of an arc from 0, with normal noise of a standard deviation.
Points cylinder(double radius, double height, double arc, double noise = 0.0) {
    constexpr int kAround = 60, kAlong = 25;
    std::mt19937 random(3);
    std::normal_distribution<double> normal(0.0, 1.0);
    Points points{Vertices(kAround * kAlong, 3), Vertices(kAround * kAlong, 3)};
    for (int i = 0; i < kAround; ++i)
        for (int j = 0; j < kAlong; ++j) {
            const double angle = arc * i / kAround, r = radius + noise * normal(random);
            const Eigen::RowVector3d n(std::cos(angle), std::sin(angle), 0.0);
            points.X.row(i * kAlong + j) = r * n;
            points.X(i * kAlong + j, 2) = height * j / (kAlong - 1);
            // Slopes of a rough surface.
            const double slope = noise > 0.0 ? 0.3 : 0.0;
            points.N.row(i * kAlong + j) =
                n + slope * Eigen::RowVector3d(normal(random), normal(random), normal(random));
        }
    return placed(points);
}

/// A cap of a sphere around the origin, up to a polar angle.
Points sphere(double radius, double largestAngle) {
    constexpr int kAround = 40, kDown = 30;
    Points points{Vertices(kAround * kDown, 3), Vertices(kAround * kDown, 3)};
    for (int i = 0; i < kAround; ++i)
        for (int j = 0; j < kDown; ++j) {
            const double polar = largestAngle * (j + 0.5) / kDown, angle = 2.0 * kPi * i / kAround;
            points.N.row(i * kDown + j) << std::sin(polar) * std::cos(angle),
                std::sin(polar) * std::sin(angle), std::cos(polar);
        }
    points.X = radius * points.N;
    return placed(points);
}

FittedShape fitted(ShapeKind kind, const Points& points) {
    return fitShape(kind, points.X, points.N, Eigen::VectorXd::Ones(points.X.rows()));
}

TEST(FormFit, FindsCylindersOfAnyPart) {
    for (const double arc : {2.0 * kPi, kPi, 0.5 * kPi, 0.3})
        for (const double height : {0.4, 3.0, 40.0}) {
            const FittedShape shape = fitted(ShapeKind::Cylinder, cylinder(2.0, height, arc));
            EXPECT_NEAR(shape.radius, 2.0, 1e-7) << arc << ' ' << height;
            const Eigen::RowVector3d axis = turn().col(2).transpose();
            EXPECT_NEAR(std::abs(shape.axis.dot(axis)), 1.0, 1e-12) << arc << ' ' << height;
            const Eigen::RowVector3d off = kShift - shape.point;
            EXPECT_NEAR((off - off.dot(axis) * axis).norm(), 0.0, 1e-6) << arc << ' ' << height;
        }
}

TEST(FormFit, FindsRoughHalfCylinders) {
    const Points points = cylinder(2.0, 5.0, kPi, 0.02);
    const FittedShape shape = fitted(ShapeKind::Cylinder, points);
    EXPECT_NEAR(shape.radius, 2.0, 0.005);
    const Eigen::VectorXd d = shape.distancesOf(points.X).d;
    EXPECT_NEAR(d.mean(), 0.0, 1e-8);  // as derived by the radius
    EXPECT_NEAR(std::sqrt(d.squaredNorm() / static_cast<double>(d.size())), 0.02, 0.001);
}

TEST(FormFit, FindsSpheresOfAnyPart) {
    for (const double angle : {kPi, 0.5 * kPi, 0.2}) {
        const FittedShape shape = fitted(ShapeKind::Sphere, sphere(3.0, angle));
        EXPECT_NEAR(shape.radius, 3.0, 1e-7) << angle;
        EXPECT_NEAR((shape.point - kShift).norm(), 0.0, 1e-7) << angle;
    }
}

TEST(FormFit, FindsPlanes) {
    Points points{Vertices::Random(50, 3), Vertices::Zero(50, 3)};
    points.X.col(2).setZero();
    points.N.col(2).setConstant(-1.0);
    points = placed(points);
    const FittedShape shape = fitted(ShapeKind::Plane, points);
    const auto [d, N] = shape.distancesOf(points.X);
    EXPECT_LT(d.cwiseAbs().maxCoeff(), 1e-13);
    EXPECT_LT((N - points.N).cwiseAbs().maxCoeff(), 1e-13);
}

TEST(FormFit, DistancesArePositiveOutsideOfTheSurface) {
    Points bore = cylinder(2.0, 5.0, kPi);
    bore.N *= -1.0;
    const FittedShape shape = fitted(ShapeKind::Cylinder, bore);
    const Eigen::RowVector3d axis = turn().col(2).transpose();
    const auto [d, N] = shape.distancesOf(kShift + axis.unitOrthogonal());
    EXPECT_NEAR(d[0], 1.0, 1e-7);  // on the side of the axis, as the surface faces it
    EXPECT_NEAR(N.row(0).dot(axis.unitOrthogonal()), -1.0, 1e-7);
}

TEST(FormFit, LeavesOutPointsWithoutWeight) {
    Points points = cylinder(2.0, 5.0, kPi);
    Eigen::VectorXd weights = Eigen::VectorXd::Ones(points.X.rows());
    for (Index i = 0; i < weights.size(); i += 3) {
        points.X.row(i).setConstant(50.0);
        weights[i] = 0.0;
    }
    EXPECT_NEAR(fitShape(ShapeKind::Cylinder, points.X, points.N, weights).radius, 2.0, 1e-7);
}

TEST(FormFit, RefusesARadiusOfAPlane) {
    Points points{Vertices::Random(50, 3), Vertices::Zero(50, 3)};
    points.X.col(2).setZero();
    points.N.col(2).setConstant(1.0);
    EXPECT_THROW(fitted(ShapeKind::Sphere, points), InvalidOption);
    EXPECT_THROW(fitted(ShapeKind::Cylinder, points), InvalidOption);
}

}  // namespace
}  // namespace spectral
