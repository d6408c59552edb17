#include "core/denoise/unfold.h"

#include <vector>

namespace spectral {

namespace {

constexpr int kMostRepetitions = 10;

/// The part within the surface of the way to the mean of the corners of the faces at vertex i.
Eigen::RowVector3d wayToMiddle(const FaceGraph& graph, const Normals& N, const Vertices& X,
                               Index i) {
    Eigen::RowVector3d sum = Eigen::RowVector3d::Zero(), normal = Eigen::RowVector3d::Zero();
    for (Index k = graph.firstFace[i]; k < graph.firstFace[i + 1]; ++k) {
        const int f = graph.faceAt[k];
        normal += N.row(f);
        for (int c = 0; c < 3; ++c) sum += X.row(graph.F(f, c)) - X.row(i);
    }
    normal.stableNormalize();
    // Of the three corners of a face one is the vertex itself.
    const Eigen::RowVector3d way =
        sum / (2.0 * static_cast<double>(graph.firstFace[i + 1] - graph.firstFace[i]));
    return way - way.dot(normal) * normal;
}

}  // namespace

void unfoldFaces(const FaceGraph& graph, const Normals& N, double farthest,
                 const std::vector<bool>& isFixed, Vertices& X) {
    for (int repetition = 0; repetition < kMostRepetitions; ++repetition) {
        const Vertices now = areaNormals(X, graph.F);
        std::vector<bool> isFolded(isFixed.size(), false);
        bool isAny = false;
        for (Index f = 0; f < graph.faceCount(); ++f) {
            if (now.row(f).dot(N.row(f)) >= 0.0) continue;
            for (int c = 0; c < 3; ++c)
                if (!isFixed[graph.F(f, c)]) isAny = isFolded[graph.F(f, c)] = true;
        }
        if (!isAny) return;
        Vertices moved = X;
        for (Index i = 0; i < graph.vertexCount(); ++i) {
            if (!isFolded[i]) continue;
            const Eigen::RowVector3d way = wayToMiddle(graph, N, X, i);
            if (way.norm() <= farthest) moved.row(i) += way;
        }
        X = moved;
    }
}

}  // namespace spectral
