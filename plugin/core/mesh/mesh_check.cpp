#include "core/mesh/mesh_check.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <string>

#include "core/mesh/mesh.h"
#include "core/support/errors.h"

namespace spectral {

namespace {

/// Height over longest edge below which the cotangents of a triangle, about its inverse, leave too
/// few digits for the factorization.
constexpr double kDegenerateAspect = 1e-10;

bool isDegenerate(const Vertices& V, const Faces& F, Index t) {
    const Eigen::RowVector3d a = V.row(F(t, 0)), b = V.row(F(t, 1)), c = V.row(F(t, 2));
    const Eigen::RowVector3d ab = b - a, ac = c - a, bc = c - b;
    const double longest2 = std::max({ab.squaredNorm(), ac.squaredNorm(), bc.squaredNorm()});
    return !(ab.cross(ac).norm() > kDegenerateAspect * longest2);
}

std::string counted(Index count, const char* one, const char* many) {
    return std::to_string(count) + " " + (count == 1 ? one : many);
}

}  // namespace

void checkMesh(const Vertices& V, const Faces& F, LaplacianKind kind) {
    if (V.rows() == 0)
        throw InvalidMesh("the mesh is empty: it has no vertices; load or create a mesh first");
    if (F.rows() == 0)
        throw InvalidMesh(
            "the mesh has " + counted(V.rows(), "vertex", "vertices") +
            " but no faces: a point cloud has no surface to take frequencies of; reconstruct one "
            "first, e.g. with 'Surface Reconstruction: Screened Poisson' or 'Surface "
            "Reconstruction: Ball Pivoting'");
    if (F.minCoeff() < 0 || F.maxCoeff() >= V.rows())
        throw InvalidMesh("a triangle refers to vertex " +
                          std::to_string(F.minCoeff() < 0 ? F.minCoeff() : F.maxCoeff()) +
                          ", but the mesh has " + counted(V.rows(), "vertex", "vertices"));

    Index notFinite = 0, firstNotFinite = -1;
    for (Index i = 0; i < V.rows(); ++i)
        if (!V.row(i).allFinite() && notFinite++ == 0) firstNotFinite = i;
    if (notFinite > 0)
        throw InvalidMesh(counted(notFinite, "vertex has", "vertices have") +
                          " coordinates that are not finite numbers (NaN or infinity), the first "
                          "is vertex " +
                          std::to_string(firstNotFinite) +
                          "; delete them, e.g. with 'Conditional Vertex Selection' (x != x) and "
                          "'Delete Selected Vertices'");

    Index degenerate = 0, firstDegenerate = -1;
    for (Index t = 0; t < F.rows(); ++t)
        if (isDegenerate(V, F, t) && degenerate++ == 0) firstDegenerate = t;
    if (degenerate == F.rows())
        throw InvalidMesh("none of the " + counted(F.rows(), "triangle", "triangles") +
                          " has an area: the mesh is a line or a point, not a surface");
    if (degenerate > 0 && kind == LaplacianKind::Cotangent)
        throw InvalidMesh(counted(degenerate, "triangle has", "triangles have") +
                          " no area, the first is triangle " + std::to_string(firstDegenerate) +
                          "; their cotangents are infinite. Choose laplacian = intrinsic delaunay, "
                          "or apply 'Merge Close Vertices', 'Remove "
                          "Duplicate Faces' and 'Remove Zero Area Faces', or remesh with "
                          "'Remeshing: Isotropic Explicit Remeshing'");
}

}  // namespace spectral
