#pragma once

#include <Eigen/Core>

#include "core/mesh/mesh.h"

namespace spectral {

enum class ShapeKind { Plane, Sphere, Cylinder };

const char* nameOf(ShapeKind kind);

/// A plane, sphere or cylinder, with a side that is outside.
struct FittedShape {
    ShapeKind kind;
    Eigen::RowVector3d point;  ///< Of the plane, or the centre, or of the axis.
    Eigen::RowVector3d axis;   ///< Unit normal of the plane, or direction of the axis; 0: none.
    double radius = 0.0;       ///< Length units; 0 of a plane.
    double outside = 1.0;      ///< -1 if the surface faces the centre or the axis, as a bore does.

    struct Distances {
        Eigen::VectorXd d;  ///< n signed distances of the points, positive outside.
        Vertices N;         ///< n x 3 unit normals of the shape at its points nearest to them.
    };
    Distances distancesOf(const Vertices& X) const;
};

/// The plane, sphere or cylinder nearest to weighted points: least squares of their distances.
///
/// Spheres and cylinders are found by Levenberg and Marquardt's method from an algebraic fit, the
/// axis of a cylinder from the normals, of which it is the direction they lack most: a part of a
/// cylinder suffices.
///
/// @param X        n x 3 points.
/// @param N        n x 3 outward normals, of any length.
/// @param weights  n, >= 0.
/// @throws InvalidOption  when the points are too few or too flat to determine the shape.
FittedShape fitShape(ShapeKind kind, const Vertices& X, const Vertices& N,
                     const Eigen::VectorXd& weights);

}  // namespace spectral
