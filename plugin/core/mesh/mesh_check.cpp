#include "core/mesh/mesh_check.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <string>

#include "core/support/errors.h"

namespace spectral {

namespace {

/// Smallest ratio of height to longest edge. Its inverse bounds the cotangents: next to 1e10, the
/// other entries of a row of W keep six digits.
constexpr double kDegenerateAspect = 1e-10;

/// Largest modulus of a coordinate: the fourth power of a length must be finite.
constexpr double kMaxCoordinate = 1e75;

std::string counted(Index count, const char* one, const char* many) {
    return std::to_string(count) + " " + (count == 1 ? one : many);
}

}  // namespace

bool isDegenerate(const Vertices& V, const Faces& F, Index t) {
    const Eigen::RowVector3d a = V.row(F(t, 0)), b = V.row(F(t, 1)), c = V.row(F(t, 2));
    const Eigen::RowVector3d ab = b - a, ac = c - a, bc = c - b;
    const double longest2 = std::max({ab.squaredNorm(), ac.squaredNorm(), bc.squaredNorm()});
    return !(ab.cross(ac).norm() > kDegenerateAspect * longest2);
}

void checkMesh(const Vertices& V, const Faces& F) {
    if (V.rows() == 0) throw InvalidMesh(ErrorCode::EmptyMesh, "the mesh is empty: no vertices");
    const std::string vertices = counted(V.rows(), "vertex", "vertices");
    if (F.rows() == 0)
        throw InvalidMesh(ErrorCode::NoFaces, "the mesh has " + vertices +
                                                  " but no faces: a point cloud has no surface");
    if (F.minCoeff() < 0 || F.maxCoeff() >= V.rows())
        throw InvalidMesh(ErrorCode::BadIndex,
                          "a triangle refers to vertex " +
                              std::to_string(F.minCoeff() < 0 ? F.minCoeff() : F.maxCoeff()) +
                              ", but the mesh has " + vertices);

    Index notFinite = 0, first = -1;
    for (Index i = 0; i < V.rows(); ++i)
        if (!(V.row(i).array().abs() <= kMaxCoordinate).all() && notFinite++ == 0) first = i;
    if (notFinite > 0)
        throw InvalidMesh(ErrorCode::NotFinite,
                          counted(notFinite, "vertex has", "vertices have") +
                              " coordinates that are not finite (NaN, infinity or beyond 1e75), "
                              "the first is vertex " +
                              std::to_string(first));

    for (Index t = 0; t < F.rows(); ++t)
        if (!isDegenerate(V, F, t)) return;
    throw InvalidMesh(ErrorCode::NoArea,
                      "all triangles have zero area: the mesh is a line or a point, not a surface");
}

void checkAreas(const Vertices& V, const Faces& F) {
    Index degenerate = 0, first = -1;
    for (Index t = 0; t < F.rows(); ++t)
        if (isDegenerate(V, F, t) && degenerate++ == 0) first = t;
    if (degenerate > 0)
        throw InvalidMesh(ErrorCode::DegenerateTriangles,
                          counted(degenerate, "triangle has", "triangles have") +
                              " no area, the first is triangle " + std::to_string(first) +
                              "; their cotangents are infinite");
}

}  // namespace spectral
