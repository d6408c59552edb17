#include "core/denoise/unfold.h"

namespace spectral {

namespace {

/// The part within the surface of the way to the mean of the corners of the faces at vertex i.
Eigen::RowVector3d wayToMiddle(const FaceGraph& graph, const Points& N, const Points& X, Index i) {
    Eigen::RowVector3d sum = Eigen::RowVector3d::Zero(), normal = Eigen::RowVector3d::Zero();
    for (Index k = graph.faces.first[i]; k < graph.faces.first[i + 1]; ++k) {
        const int f = graph.faces.at[k];
        normal += N.row(f);
        for (int c = 0; c < 3; ++c) sum += X.row(graph.F(f, c)) - X.row(i);
    }
    normal.stableNormalize();
    // Of the three corners of a face one is the vertex itself.
    const Eigen::RowVector3d way = sum / (2.0 * static_cast<double>(graph.faces.degree(i)));
    return way - way.dot(normal) * normal;
}

}  // namespace

void unfoldFaces(const FaceGraph& graph, const Points& N, double farthest,
                 const std::vector<bool>& mayMove, Points& X) {
    constexpr int kMostRepetitions = 20;
    constexpr double kLeastCosine = 0.5;  // of a face with its filtered normal
    for (int repetition = 0; repetition < kMostRepetitions; ++repetition) {
        const Points now = areaNormals(X, graph.F);
        std::vector<bool> isFolded(mayMove.size(), false);
        bool isAny = false;
        for (Index f = 0; f < graph.faceCount(); ++f) {
            if (now.row(f).dot(N.row(f)) >= kLeastCosine * now.row(f).norm()) continue;
            for (int c = 0; c < 3; ++c)
                if (mayMove[graph.F(f, c)]) isAny = isFolded[graph.F(f, c)] = true;
        }
        if (!isAny) return;
        Points moved = X;
        for (Index i = 0; i < graph.vertexCount(); ++i) {
            if (!isFolded[i]) continue;
            const Eigen::RowVector3d way = wayToMiddle(graph, N, X, i);
            if (way.norm() <= farthest) moved.row(i) += way;
        }
        X = moved;
    }
}

}  // namespace spectral
