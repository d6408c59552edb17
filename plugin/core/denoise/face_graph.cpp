#include "core/denoise/face_graph.h"

#include <Eigen/Geometry>
#include <utility>

#include "core/mesh/sides.h"
#include "core/support/threads.h"

namespace spectral {

namespace {

/// The neighbours of a face, at most one for each side.
struct Neighbours {
    int count = 0;
    int face[3];
    bool isOpposite[3];  ///< Whether it is oriented against the face.
    void add(int neighbour, bool opposite) {
        face[count] = neighbour;
        isOpposite[count++] = opposite;
    }
};

/// Reverses faces until neighbours are oriented alike, from the first face of each component on.
void orient(const std::vector<Neighbours>& neighbours, Faces& F) {
    std::vector<char> isReached(static_cast<std::size_t>(F.rows()), 0);
    std::vector<std::pair<int, bool>> left;
    for (int first = 0; first < F.rows(); ++first) {
        if (!isReached[first]) left.emplace_back(first, false);
        isReached[first] = 1;
        while (!left.empty()) {
            const auto [face, isReversed] = left.back();
            left.pop_back();
            if (isReversed) std::swap(F(face, 1), F(face, 2));
            const Neighbours& around = neighbours[face];
            for (int k = 0; k < around.count; ++k) {
                if (isReached[around.face[k]]) continue;
                isReached[around.face[k]] = 1;
                left.emplace_back(around.face[k], isReversed != around.isOpposite[k]);
            }
        }
    }
}

}  // namespace

FaceGraph faceGraph(const Faces& F, Index vertexCount) {
    FaceGraph graph;
    graph.F = F;
    graph.onRim.assign(static_cast<std::size_t>(vertexCount), false);
    std::vector<Neighbours> neighbours(static_cast<std::size_t>(F.rows()));
    // Whether the face runs through the side from its higher to its lower vertex.
    const auto isReversed = [&](const Side& side) {
        return F(side.face, (side.opposite + 1) % 3) == side.high;
    };
    forEachEdge(sidesByEdge(F), [&](auto first, auto end) {
        if (end - first != 2) {
            graph.onRim[first->low] = graph.onRim[first->high] = true;
            return;
        }
        const Side &a = *first, &b = *(first + 1);
        graph.edges.push_back({{a.face, b.face}, {a.low, a.high}});
        const bool isOpposite = isReversed(a) == isReversed(b);
        neighbours[a.face].add(b.face, isOpposite);
        neighbours[b.face].add(a.face, isOpposite);
    });
    orient(neighbours, graph.F);

    graph.firstFace.assign(static_cast<std::size_t>(vertexCount) + 1, 0);
    for (Index t = 0; t < F.rows(); ++t)
        for (int c = 0; c < 3; ++c) ++graph.firstFace[F(t, c) + 1];
    for (Index i = 0; i < vertexCount; ++i) graph.firstFace[i + 1] += graph.firstFace[i];
    graph.faceAt.resize(static_cast<std::size_t>(3 * F.rows()));
    std::vector<Index> end(graph.firstFace.begin(), graph.firstFace.end() - 1);
    for (Index t = 0; t < F.rows(); ++t)
        for (int c = 0; c < 3; ++c) graph.faceAt[end[F(t, c)]++] = static_cast<int>(t);
    return graph;
}

Vertices areaNormals(const Vertices& X, const Faces& F) {
    Vertices N(F.rows(), 3);
    parallelRows(F.rows(), [&](Index begin, Index end) {
        for (Index t = begin; t < end; ++t) {
            const Eigen::RowVector3d a = X.row(F(t, 0)), b = X.row(F(t, 1)), c = X.row(F(t, 2));
            N.row(t) = (b - a).cross(c - a);
        }
    });
    return N;
}

Normals faceNormals(const Vertices& X, const Faces& F) {
    Normals N = areaNormals(X, F);
    normalizeRows(N);
    return N;
}

void normalizeRows(Normals& N) {
    parallelRows(N.rows(), [&](Index begin, Index end) {
        for (Index t = begin; t < end; ++t) N.row(t).stableNormalize();
    });
}

Vertices blurredNormals(const FaceGraph& graph, Vertices N, int times) {
    for (int k = 0; k < times; ++k) {
        Vertices sum = N;
        for (const FaceGraph::Edge& edge : graph.edges) {
            sum.row(edge.faces[0]) += N.row(edge.faces[1]);
            sum.row(edge.faces[1]) += N.row(edge.faces[0]);
        }
        N = std::move(sum);
    }
    return N;
}

}  // namespace spectral
