#include "core/denoise/vertex_update.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/support/threads.h"

namespace spectral {

namespace {

/// @param step  (vertex, mean of n n^T (c - x), its faces) -> displacement.
template <class Step>
Points follow(const FaceGraph& graph, Points X, const Points& N, const std::vector<bool>& mayMove,
              int sweeps, const Step& step) {
    const VertexGraph& faces = graph.faces;
    Eigen::VectorXd height(graph.faceCount());  // n_f^T c_f
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        parallelRows(graph.faceCount(), [&](Index begin, Index end) {
            for (Index f = begin; f < end; ++f) {
                const Eigen::RowVector3d corners =
                    X.row(graph.F(f, 0)) + X.row(graph.F(f, 1)) + X.row(graph.F(f, 2));
                height[f] = N.row(f).dot(corners) / 3.0;
            }
        });
        parallelRows(graph.vertexCount(), [&](Index begin, Index end) {
            for (Index i = begin; i < end; ++i) {
                if (!mayMove[i] || faces.degree(i) == 0) continue;
                const Eigen::RowVector3d x = X.row(i);
                Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
                for (Index k = faces.first[i]; k < faces.first[i + 1]; ++k) {
                    const int f = faces.at[k];
                    sum += (height[f] - N.row(f).dot(x)) * N.row(f);
                }
                X.row(i) = x + step(i, sum / static_cast<double>(faces.degree(i)));
            }
        });
    }
    return X;
}

}  // namespace

Points followNormals(const FaceGraph& graph, Points X, const Points& N,
                     const std::vector<bool>& mayMove, int sweeps) {
    return follow(graph, std::move(X), N, mayMove, sweeps,
                  [](Index, const Eigen::RowVector3d& mean) { return mean; });
}

Points followNormalsAlong(const FaceGraph& graph, Points X, const Points& N, const Points& D,
                          const std::vector<bool>& mayMove, int sweeps) {
    constexpr double kMinShare = 0.3;  // of the faces, seen along D: grazing rays are held back
    Eigen::VectorXd scale(X.rows());
    for (Index i = 0; i < X.rows(); ++i) {
        double squares = 0.0;
        for (Index k = graph.faces.first[i]; k < graph.faces.first[i + 1]; ++k)
            squares += std::pow(N.row(graph.faces.at[k]).dot(D.row(i)), 2);
        const double count = static_cast<double>(std::max<Index>(graph.faces.degree(i), 1));
        scale[i] = std::max(squares / count, kMinShare);
    }
    return follow(graph, std::move(X), N, mayMove, sweeps,
                  [&](Index i, const Eigen::RowVector3d& mean) -> Eigen::RowVector3d {
                      return mean.dot(D.row(i)) / scale[i] * D.row(i);
                  });
}

}  // namespace spectral
