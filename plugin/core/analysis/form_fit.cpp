#include "core/analysis/form_fit.h"

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "core/support/dense_solvers.h"
#include "core/support/errors.h"

namespace spectral {

namespace {

using Row = Eigen::RowVector3d;

/// The part of q that the distance from a centre or an axis depends on.
Row radial(const FittedShape& shape, const Row& x) {
    const Row q = x - shape.point;
    return q - q.dot(shape.axis) * shape.axis;  // a sphere has no axis
}

FittedShape fittedPlane(const Vertices& X, const Eigen::VectorXd& weights) {
    const Row mean = weights.transpose() * X / weights.sum();
    const Vertices Q = X.rowwise() - mean;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> moments(Q.transpose() *
                                                                 weights.asDiagonal() * Q);
    return {ShapeKind::Plane, mean, moments.eigenvectors().col(0).transpose()};
}

/// Centre c and radius of |x|^2 = 2 c . x + (r^2 - |c|^2), by linear least squares (Kasa 1976), in
/// the plane across the axis if there is one.
FittedShape algebraicFit(ShapeKind kind, const Row& axis, const Vertices& X,
                         const Eigen::VectorXd& weights) {
    FittedShape shape{kind, weights.transpose() * X / weights.sum(), axis};
    // The mean of q is 0: centre and radius are found apart.
    Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    double squares = 0.0;
    for (Index i = 0; i < X.rows(); ++i) {
        const Row q = radial(shape, X.row(i));
        A += weights[i] * q.transpose() * q;
        b += weights[i] * q.squaredNorm() * q.transpose();
        squares += weights[i] * q.squaredNorm();
    }
    // No part of the centre lies along the axis.
    constexpr double kRoundOff = 4.0 * std::numeric_limits<double>::epsilon();
    const Row centre = 0.5 * leastNormSolution(A, b, kRoundOff).transpose();
    shape.point += centre;
    shape.radius = std::sqrt(squares / weights.sum() + centre.squaredNorm());
    return shape;
}

double squaredError(const FittedShape& shape, const Vertices& X, const Eigen::VectorXd& weights) {
    double sum = 0.0;
    for (Index i = 0; i < X.rows(); ++i)
        sum += weights[i] * std::pow(radial(shape, X.row(i)).norm() - shape.radius, 2);
    return sum;
}

/// Changes of a shape: of its point along three axes, of the direction of its axis by turns about
/// two of them, of its radius. What a shape does not depend on has derivative 0.
using Change = Eigen::Matrix<double, 6, 1>;

FittedShape changed(const FittedShape& shape, const Eigen::Matrix3d& frame, double size,
                    const Change& by) {
    FittedShape other = shape;
    other.point += by.head<3>().transpose() * frame;
    other.axis += (by.segment<2>(3).transpose() / size) * frame.topRows<2>();
    if (shape.kind == ShapeKind::Cylinder) other.axis.normalize();
    other.radius += by[5];
    return other;
}

/// Unit vectors as rows, the last along the axis if there is one.
Eigen::Matrix3d frameOf(const FittedShape& shape) {
    if (shape.kind == ShapeKind::Sphere) return Eigen::Matrix3d::Identity();
    Eigen::Matrix3d frame;
    frame.row(0) = shape.axis.unitOrthogonal();
    frame.row(1) = shape.axis.cross(frame.row(0));
    frame.row(2) = shape.axis;
    return frame;
}

/// Normal equations of the linearized distances; turns are in units of 1 / size.
std::pair<Eigen::Matrix<double, 6, 6>, Change> normalEquations(const FittedShape& shape,
                                                               const Eigen::Matrix3d& frame,
                                                               double size, const Vertices& X,
                                                               const Eigen::VectorXd& weights) {
    Eigen::Matrix<double, 6, 6> A = Eigen::Matrix<double, 6, 6>::Zero();
    Change b = Change::Zero();
    for (Index i = 0; i < X.rows(); ++i) {
        const Row q = radial(shape, X.row(i));
        const double distance = q.norm();
        if (weights[i] == 0.0 || distance == 0.0) continue;
        const Eigen::Vector3d n = frame * q.transpose() / distance;
        Change J = Change::Zero();
        J.head<3>() = -n;
        if (shape.kind == ShapeKind::Cylinder) {
            J[2] = 0.0;
            J.segment<2>(3) = -(X.row(i) - shape.point).dot(shape.axis) / size * n.head<2>();
        }
        J[5] = -1.0;
        A += weights[i] * J * J.transpose();
        b -= weights[i] * (distance - shape.radius) * J;
    }
    return {A, b};
}

constexpr int kMaxSteps = 100;

FittedShape refined(FittedShape shape, const Vertices& X, const Eigen::VectorXd& weights,
                    int maxSteps = kMaxSteps) {
    constexpr double kSmallest = 1e-14;  // relative step
    const double size = X.rowwise().norm().maxCoeff();
    double error = squaredError(shape, X, weights), damping = 1e-4;
    for (int step = 0; step < maxSteps && damping < 1e8; ++step) {
        const Eigen::Matrix3d frame = frameOf(shape);
        auto [A, b] = normalEquations(shape, frame, size, X, weights);
        A.diagonal() += Change::Constant(damping * weights.sum());
        const Change by = A.ldlt().solve(b);
        const FittedShape next = changed(shape, frame, size, by);
        const double nextError = squaredError(next, X, weights);
        if (!(nextError <= error)) {
            damping *= 10.0;
            continue;
        }
        shape = next;
        error = nextError;
        damping *= 0.1;
        if (by.norm() <= kSmallest * size) break;
    }
    return shape;
}

FittedShape fittedSphere(const Vertices& X, const Eigen::VectorXd& weights) {
    return refined(algebraicFit(ShapeKind::Sphere, Row::Zero(), X, weights), X, weights);
}

/// From the direction that the normals lack most; on a rough, short arc it may be another one.
FittedShape fittedCylinder(const Vertices& X, const Vertices& N, const Eigen::VectorXd& weights) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> moments(N.transpose() *
                                                                 weights.asDiagonal() * N);
    constexpr int kTrials =
        10;  // steps that tell directions apart; wrong ones would go on for long
    FittedShape best{ShapeKind::Cylinder, Row::Zero(), Row::Zero()};
    double least = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) {
        const Row axis = moments.eigenvectors().col(k).transpose();
        const FittedShape one =
            refined(algebraicFit(ShapeKind::Cylinder, axis, X, weights), X, weights, kTrials);
        const double error = squaredError(one, X, weights);
        if (!(error < least)) continue;
        best = one;
        least = error;
    }
    return refined(best, X, weights);
}

/// Whether a plane is at least as near to the points: then they have no radius.
bool isFlat(const FittedShape& shape, const Vertices& X, const Eigen::VectorXd& weights) {
    const Eigen::VectorXd d = fittedPlane(X, weights).distancesOf(X).d;
    return !(squaredError(shape, X, weights) < weights.dot(d.cwiseAbs2()));
}

}  // namespace

const char* nameOf(ShapeKind kind) {
    return kind == ShapeKind::Plane ? "plane" : kind == ShapeKind::Sphere ? "sphere" : "cylinder";
}

FittedShape::Distances FittedShape::distancesOf(const Vertices& X) const {
    Distances distances{Eigen::VectorXd(X.rows()), Vertices(X.rows(), 3)};
    for (Index i = 0; i < X.rows(); ++i) {
        if (kind == ShapeKind::Plane) {
            distances.N.row(i) = outside * axis;
            distances.d[i] = outside * (X.row(i) - point).dot(axis);
            continue;
        }
        const Row q = radial(*this, X.row(i));
        const double distance = q.norm();
        distances.N.row(i) = distance > 0.0 ? Row(outside * q / distance) : Row(Row::Zero());
        distances.d[i] = outside * (distance - radius);
    }
    return distances;
}

FittedShape fitShape(ShapeKind kind, const Vertices& X, const Vertices& N,
                     const Eigen::VectorXd& weights) {
    FittedShape shape = kind == ShapeKind::Plane    ? fittedPlane(X, weights)
                        : kind == ShapeKind::Sphere ? fittedSphere(X, weights)
                                                    : fittedCylinder(X, N, weights);
    if (kind != ShapeKind::Plane && isFlat(shape, X, weights))
        throw InvalidOption(std::string("form = ") + nameOf(kind) +
                            ": the surface is too flat to have a radius, choose plane or size");
    const FittedShape::Distances distances = shape.distancesOf(X);
    if ((distances.N.cwiseProduct(N).rowwise().sum()).dot(weights) < 0.0) shape.outside = -1.0;
    return shape;
}

}  // namespace spectral
