#include "core/mesh/surface.h"

#include "core/mesh/seams.h"
#include "core/mesh/union_find.h"

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

Surface joinedSurface(const Vertices& V, const Faces& F) {
    Surface cut = surfaceOf(V, F);
    const Seams seams = findSeams(cut.X, cut.F);
    if (seams.first.empty()) {
        cut.nearlyCopies = seams.nearby;
        return cut;
    }
    Surface surface = surfaceOf(cut.X, cut.F.unaryExpr([&](int i) { return seams.first[i]; }));
    if (surface.F.rows() == 0) return cut;  // all triangles degenerate once joined
    surface.nearlyCopies = seams.nearby;
    std::vector<Index> row(seams.first.size(), -1);
    for (Index i = 0; i < surface.X.rows(); ++i) row[surface.vertex[i]] = i;
    for (std::size_t i = 0; i < row.size(); ++i)
        if (seams.first[i] != static_cast<int>(i) && row[seams.first[i]] >= 0)
            surface.copies.push_back({cut.vertex[i], row[seams.first[i]]});
    for (Index& vertex : surface.vertex) vertex = cut.vertex[vertex];
    return surface;
}

Eigen::MatrixXd restricted(const Eigen::MatrixXd& values, const Surface& surface) {
    Eigen::MatrixXd mean = values(surface.vertex, Eigen::indexing::all);
    if (surface.copies.empty()) return mean;
    Eigen::VectorXd count = Eigen::VectorXd::Ones(mean.rows());
    for (const Surface::Copy& copy : surface.copies) count[copy.row] += 1.0;
    // By differences: the mean of equal values is then exactly that value.
    for (const auto& [vertex, row] : surface.copies)
        mean.row(row) += (values.row(vertex) - values.row(surface.vertex[row])) / count[row];
    return mean;
}

Eigen::MatrixXd extended(Eigen::MatrixXd values, const Surface& surface, Index n) {
    Eigen::MatrixXd onMesh = extendedByZero(std::move(values), surface.vertex, n);
    for (const auto& [vertex, row] : surface.copies)
        onMesh.row(vertex) = onMesh.row(surface.vertex[row]);
    return onMesh;
}

Eigen::MatrixXd changed(const Eigen::MatrixXd& values, const Surface& surface,
                        const Eigen::MatrixXd& change) {
    const Eigen::MatrixXd before = restricted(values, surface);
    Eigen::MatrixXd after = values;
    const auto set = [&](Index vertex, Index row) {
        for (Index c = 0; c < values.cols(); ++c)
            if (change(row, c) != 0.0) after(vertex, c) = before(row, c) + change(row, c);
    };
    for (Index i = 0; i < before.rows(); ++i) set(surface.vertex[i], i);
    for (const auto& [vertex, row] : surface.copies) set(vertex, row);
    return after;
}

Eigen::MatrixXd extendedByZero(Eigen::MatrixXd values, const std::vector<Index>& vertex, Index n) {
    if (values.rows() == n) return values;
    Eigen::MatrixXd extended = Eigen::MatrixXd::Zero(n, values.cols());
    for (Index i = 0; i < values.rows(); ++i) extended.row(vertex[i]) = values.row(i);
    return extended;
}

SurfaceCounts countsOf(const Surface& surface, Index n, int components, Index fixed) {
    SurfaceCounts counts;
    counts.components = components;
    counts.fixedVertices = static_cast<int>(fixed);
    counts.joinedVertices = static_cast<int>(surface.copies.size());
    counts.unreferencedVertices = static_cast<int>(n - surface.X.rows()) - counts.joinedVertices;
    counts.nearlyJoined = surface.nearlyCopies;
    return counts;
}

Components connectedComponents(const Faces& F, Index vertexCount) {
    UnionFind sets(vertexCount);
    for (Index t = 0; t < F.rows(); ++t) {
        sets.unite(F(t, 0), F(t, 1));
        sets.unite(F(t, 0), F(t, 2));
    }
    // Components are numbered by their first vertices, which are the roots.
    Components components{Eigen::VectorXi(vertexCount), 0};
    for (int i = 0; i < vertexCount; ++i) {
        const int first = sets.root(i);
        components.label[i] = first == i ? components.count++ : components.label[first];
    }
    return components;
}

}  // namespace spectral
