#include "core/denoise/unfold.h"

namespace spectral {

namespace {

/// Tangential displacement of vertex i to the mean of the other corners of its faces.
Eigen::RowVector3d displacementToMean(const FaceGraph& graph, const Points& N, const Points& X,
                                      Index i) {
    Eigen::RowVector3d sum = Eigen::RowVector3d::Zero(), normal = Eigen::RowVector3d::Zero();
    for (Index k = graph.faces.first[i]; k < graph.faces.first[i + 1]; ++k) {
        const int f = graph.faces.at[k];
        normal += N.row(f);
        for (int c = 0; c < 3; ++c) sum += X.row(graph.F(f, c)) - X.row(i);
    }
    normal.stableNormalize();
    // One of the three corners of each face is the vertex itself.
    const Eigen::RowVector3d toMean = sum / (2.0 * static_cast<double>(graph.faces.degree(i)));
    return toMean - toMean.dot(normal) * normal;
}

}  // namespace

void unfoldFaces(const FaceGraph& graph, const Points& N, const Eigen::VectorXd& maxDisplacement,
                 const std::vector<bool>& mayMove, Points& X) {
    constexpr int kMaxRepetitions = 20;
    constexpr double kMinCosine = 0.5;  // between a face's normal and its filtered normal
    for (int repetition = 0; repetition < kMaxRepetitions; ++repetition) {
        const Points now = areaNormals(X, graph.F);
        std::vector<bool> isFolded(mayMove.size(), false);
        bool isAny = false;
        for (Index f = 0; f < graph.faceCount(); ++f) {
            if (now.row(f).dot(N.row(f)) >= kMinCosine * now.row(f).norm()) continue;
            for (int c = 0; c < 3; ++c)
                if (mayMove[graph.F(f, c)]) isAny = isFolded[graph.F(f, c)] = true;
        }
        if (!isAny) return;
        Points moved = X;
        for (Index i = 0; i < graph.vertexCount(); ++i) {
            if (!isFolded[i]) continue;
            const Eigen::RowVector3d displacement = displacementToMean(graph, N, X, i);
            if (displacement.norm() <= maxDisplacement[i]) moved.row(i) += displacement;
        }
        X = moved;
    }
}

}  // namespace spectral
