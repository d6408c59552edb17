#include "core/mesh/surface.h"

#include <algorithm>
#include <numeric>

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

Eigen::MatrixXd extendedByZero(Eigen::MatrixXd values, const std::vector<Index>& vertex, Index n) {
    if (values.rows() == n) return values;
    Eigen::MatrixXd extended = Eigen::MatrixXd::Zero(n, values.cols());
    for (Index i = 0; i < values.rows(); ++i) extended.row(vertex[i]) = values.row(i);
    return extended;
}

Components connectedComponents(const Faces& F, Index vertexCount) {
    // Union-find with path halving.
    std::vector<int> parent(static_cast<std::size_t>(vertexCount));
    std::iota(parent.begin(), parent.end(), 0);
    const auto root = [&](int i) {
        while (parent[i] != i) i = parent[i] = parent[parent[i]];
        return i;
    };
    // The smaller index becomes the root: components are numbered by their first vertices.
    const auto unite = [&](int i, int j) {
        const auto [first, second] = std::minmax({root(i), root(j)});
        parent[second] = first;
    };
    for (Index t = 0; t < F.rows(); ++t) {
        unite(F(t, 0), F(t, 1));
        unite(F(t, 0), F(t, 2));
    }
    Components components{Eigen::VectorXi(vertexCount), 0};
    for (int i = 0; i < vertexCount; ++i) {
        const int first = root(i);
        components.label[i] = first == i ? components.count++ : components.label[first];
    }
    return components;
}

}  // namespace spectral
