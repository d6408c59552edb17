#include "core/mesh/surface.h"

#include "core/mesh/mesh.h"

namespace spectral {

Surface surfaceOf(const Vertices& V, const Faces& F) {
    Surface surface;
    surface.F.resize(F.rows(), 3);
    std::vector<int> packed(static_cast<std::size_t>(V.rows()), -1);
    Index triangles = 0;
    for (Index t = 0; t < F.rows(); ++t) {
        if (F(t, 0) == F(t, 1) || F(t, 1) == F(t, 2) || F(t, 2) == F(t, 0)) continue;
        surface.F.row(triangles++) = F.row(t);
        for (int c = 0; c < 3; ++c) packed[F(t, c)] = 0;
    }
    surface.F.conservativeResize(triangles, 3);

    for (Index i = 0; i < V.rows(); ++i)
        if (packed[i] == 0) {
            packed[i] = static_cast<int>(surface.vertex.size());
            surface.vertex.push_back(i);
        }
    surface.F = surface.F.unaryExpr([&](int i) { return packed[i]; }).eval();

    surface.X.resize(static_cast<Index>(surface.vertex.size()), 3);
    for (Index i = 0; i < surface.X.rows(); ++i) surface.X.row(i) = V.row(surface.vertex[i]);
    if (surface.X.rows() > 0) {
        const Eigen::RowVector3d middle =
            0.5 * (surface.X.colwise().maxCoeff() + surface.X.colwise().minCoeff());
        surface.X.rowwise() -= middle;
    }
    return surface;
}

}  // namespace spectral
