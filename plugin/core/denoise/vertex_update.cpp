#include "core/denoise/vertex_update.h"

#include "core/support/threads.h"

namespace spectral {

Points followNormals(const FaceGraph& graph, Points X, const Points& N,
                     const std::vector<bool>& mayMove, int sweeps) {
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
                if (!mayMove[i]) continue;
                const Eigen::RowVector3d x = X.row(i);
                Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
                for (Index k = faces.first[i]; k < faces.first[i + 1]; ++k) {
                    const int f = faces.at[k];
                    sum += (height[f] - N.row(f).dot(x)) * N.row(f);
                }
                X.row(i) = x + sum / static_cast<double>(faces.degree(i));
            }
        });
    }
    return X;
}

}  // namespace spectral
