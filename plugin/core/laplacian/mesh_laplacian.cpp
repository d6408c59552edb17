#include "core/laplacian/mesh_laplacian.h"

#include <utility>

#include "core/laplacian/constant_modes.h"
#include "core/mesh/mesh.h"
#include "core/mesh/mesh_check.h"
#include "core/support/errors.h"

namespace spectral {

MeshLaplacian meshLaplacian(const Vertices& V, const Faces& F, LaplacianKind kind) {
    checkMesh(V, F, kind);
    Surface surface = surfaceOf(V, F);
    Components components = connectedComponents(surface.F, surface.X.rows());
    Laplacian laplacian = LaplacianBuilder(surface, kind, BasisUpdate::None).input();
    if (!isUsable(laplacian))
        throw SolverFailure(
            "a cotangent or a mass of the mesh is not finite: some triangles are nearly without "
            "area. Choose laplacian = intrinsic delaunay");
    ConstantModes constants(components, laplacian.D);
    return {std::move(surface), std::move(components), std::move(laplacian), std::move(constants)};
}

Eigen::MatrixXd onMesh(const Surface& surface, Eigen::MatrixXd values, Index vertexCount) {
    if (values.rows() == vertexCount) return values;
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(vertexCount, values.cols());
    for (Index i = 0; i < values.rows(); ++i) all.row(surface.vertex[i]) = values.row(i);
    return all;
}

}  // namespace spectral
