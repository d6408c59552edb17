#include "core/mesh/surface.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "core/mesh/mesh_check.h"
#include "core/mesh/union_find.h"

namespace spectral {

Surface surfaceOf(const VerticesView& V, const FacesView& F) {
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

    surface.vertex.reserve(packed.size() - std::count(packed.begin(), packed.end(), -1));
    for (Index i = 0; i < V.rows(); ++i)
        if (packed[i] == 0) {
            packed[i] = static_cast<int>(surface.vertex.size());
            surface.vertex.push_back(i);
        }
    for (int& i : surface.F.reshaped()) i = packed[i];

    surface.X.resize(static_cast<Index>(surface.vertex.size()), 3);
    for (Index i = 0; i < surface.X.rows(); ++i) surface.X.row(i) = V.row(surface.vertex[i]);
    if (surface.X.rows() > 0) {
        const Eigen::RowVector3d middle =
            0.5 * (surface.X.colwise().maxCoeff() + surface.X.colwise().minCoeff());
        surface.X.rowwise() -= middle;
    }
    return surface;
}

namespace {

using Triangle = std::array<int, 3>;
using Points = std::array<std::vector<int>, 3>;  // on the sides of a triangle, in its order

/// Appends a triangle, split at the points on its sides.
void appendSplit(Triangle triangle, Points points, std::vector<Triangle>& split) {
    for (int turn = 0; turn < 2 && points[0].empty(); ++turn) {
        std::rotate(triangle.begin(), triangle.begin() + 1, triangle.end());
        std::rotate(points.begin(), points.begin() + 1, points.end());
    }
    if (points[0].empty()) {
        split.push_back(triangle);
        return;
    }
    const auto [a, b, c] = triangle;
    const std::vector<int>& along = points[0];
    appendSplit({a, along.front(), c}, {{{}, {}, points[2]}}, split);
    for (std::size_t k = 1; k < along.size(); ++k) split.push_back({along[k - 1], along[k], c});
    appendSplit({along.back(), b, c}, {{{}, points[1], {}}}, split);
}

/// Splits triangles at the vertices that hang on their sides.
Faces splitAt(const std::vector<Hanging>& hanging, const Faces& F) {
    std::map<int, Points> points;  // of the triangles
    for (const Hanging& one : hanging) {
        const int t = one.side / 3, c = one.side % 3;
        std::vector<int>& along = points[t][c];
        along.insert(F(t, c) == one.from ? along.end() : along.begin(), one.vertex);
    }
    std::vector<Triangle> triangles;
    for (Index t = 0; t < F.rows(); ++t) {
        const Triangle triangle{F(t, 0), F(t, 1), F(t, 2)};
        const auto found = points.find(static_cast<int>(t));
        if (found == points.end())
            triangles.push_back(triangle);
        else
            appendSplit(triangle, found->second, triangles);
    }
    Faces split(static_cast<Index>(triangles.size()), 3);
    for (Index t = 0; t < split.rows(); ++t)
        for (int c = 0; c < 3; ++c) split(t, c) = triangles[t][c];
    return split;
}

/// Leaves out components all of whose triangles have no area: their Laplacian is infinite.
void removeFlatComponents(Surface& surface) {
    std::vector<bool> isFlat(static_cast<std::size_t>(surface.F.rows()));
    for (Index t = 0; t < surface.F.rows(); ++t) isFlat[t] = isDegenerate(surface.X, surface.F, t);
    if (std::find(isFlat.begin(), isFlat.end(), true) == isFlat.end()) return;
    const Components components = connectedComponents(surface.F, surface.X.rows());
    std::vector<bool> hasArea(static_cast<std::size_t>(components.count), false);
    for (Index t = 0; t < surface.F.rows(); ++t)
        if (!isFlat[t]) hasArea[components.label[surface.F(t, 0)]] = true;
    const auto flat = std::count(hasArea.begin(), hasArea.end(), false);
    if (flat == 0 || flat == components.count) return;
    Index kept = 0;
    for (Index t = 0; t < surface.F.rows(); ++t)
        if (hasArea[components.label[surface.F(t, 0)]])
            surface.F.row(kept++) = surface.F.row(t).eval();
    surface.F.conservativeResize(kept, 3);
    Surface rest = surfaceOf(surface.X, surface.F);
    for (Index& vertex : rest.vertex) vertex = surface.vertex[vertex];
    surface = std::move(rest);
    surface.flatComponents = static_cast<int>(flat);
}

/// joinedSurface without its edges, unless they are those of what is cut.
std::pair<Surface, std::optional<SidesByEdge>> joined(const VerticesView& V, const FacesView& F) {
    Surface cut = surfaceOf(V, F);
    removeFlatComponents(cut);
    SidesByEdge edges(cut.F);
    const Seams seams = findSeams(cut.X, cut.F, edges);
    if (seams.first.empty() && seams.hanging.empty()) {
        cut.nearlyCopies = seams.nearby;
        return {std::move(cut), std::move(edges)};
    }
    std::vector<int> first = seams.first;
    if (first.empty()) {
        first.resize(cut.vertex.size());
        std::iota(first.begin(), first.end(), 0);
    }
    Faces whole = cut.F.unaryExpr([&](int i) { return first[i]; });
    if (!seams.hanging.empty()) whole = splitAt(seams.hanging, whole);
    Surface surface = surfaceOf(cut.X, whole);
    if (surface.F.rows() == 0)  // all triangles degenerate once joined
        return {std::move(cut), std::move(edges)};
    surface.nearlyCopies = seams.nearby;
    surface.flatComponents = cut.flatComponents;
    std::vector<Index> row(first.size(), -1);
    for (Index i = 0; i < surface.X.rows(); ++i) row[surface.vertex[i]] = i;
    for (std::size_t i = 0; i < row.size(); ++i)
        if (first[i] != static_cast<int>(i) && row[first[i]] >= 0)
            surface.copies.push_back({cut.vertex[i], row[first[i]]});
    for (Hanging one : seams.hanging)
        if (one.follows) {
            for (int* end : {&one.vertex, &one.from, &one.to}) *end = static_cast<int>(row[*end]);
            surface.hanging.push_back(one);
        }
    for (Index& vertex : surface.vertex) vertex = cut.vertex[vertex];
    return {std::move(surface), std::nullopt};
}

}  // namespace

Surface joinedSurface(const VerticesView& V, const FacesView& F) { return joined(V, F).first; }

SurfaceWithEdges joinedSurfaceWithEdges(const VerticesView& V, const FacesView& F) {
    auto [surface, edges] = joined(V, F);
    if (!edges) edges.emplace(surface.F);
    return {std::move(surface), *std::move(edges)};
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

void keepFixed(const std::vector<bool>& isFixed, Surface& surface) {
    auto& hanging = surface.hanging;
    hanging.erase(std::remove_if(hanging.begin(), hanging.end(),
                                 [&](const Hanging& one) { return isFixed[one.vertex]; }),
                  hanging.end());
}

void followEdges(const Surface& surface, Vertices& displacement) {
    for (const Hanging& one : surface.hanging)
        displacement.row(one.vertex) =
            (1.0 - one.share) * displacement.row(one.from) + one.share * displacement.row(one.to);
}

Vertices moved(const Vertices& V, const Surface& surface, const Vertices& displacement) {
    Vertices after = changed(V, surface, displacement);
    if (surface.hanging.empty()) return after;
    std::vector<bool> follows(surface.vertex.size(), false);
    for (const Hanging& one : surface.hanging) {
        const Index i = surface.vertex[one.vertex], from = surface.vertex[one.from],
                    to = surface.vertex[one.to];
        if (displacement.row(one.from).isZero(0.0) && displacement.row(one.to).isZero(0.0))
            continue;
        after.row(i) = (1.0 - one.share) * after.row(from) + one.share * after.row(to);
        follows[one.vertex] = true;
    }
    for (const auto& [vertex, row] : surface.copies)
        if (follows[row]) after.row(vertex) = after.row(surface.vertex[row]);
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
    counts.flatComponents = surface.flatComponents;
    return counts;
}

Components connectedComponents(const Faces& F, Index vertexCount) {
    UnionFind sets(vertexCount);
    for (Index t = 0; t < F.rows(); ++t) {
        sets.unite(F(t, 0), F(t, 1));
        sets.unite(F(t, 0), F(t, 2));
    }
    // Components are numbered by their first vertices, which are the roots.
    Eigen::VectorXi label(vertexCount);
    int count = 0;
    for (int i = 0; i < vertexCount; ++i) {
        const int first = sets.root(i);
        label[i] = first == i ? count++ : label[first];
    }
    return {std::move(label), count};
}

}  // namespace spectral
