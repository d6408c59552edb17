#include "core/denoise/vertex_update.h"

#include "core/support/threads.h"

namespace spectral {

Vertices followNormals(const FaceGraph& graph, Vertices X, const Normals& N,
                       const std::vector<bool>& isFixed, int sweeps) {
    Vertices pulls(graph.faceCount(), 3);  // n_f n_f^T c_f
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        parallelRows(graph.faceCount(), [&](Index begin, Index end) {
            for (Index f = begin; f < end; ++f) {
                const Eigen::RowVector3d centroid =
                    (X.row(graph.F(f, 0)) + X.row(graph.F(f, 1)) + X.row(graph.F(f, 2))) / 3.0;
                pulls.row(f) = N.row(f).dot(centroid) * N.row(f);
            }
        });
        parallelRows(graph.vertexCount(), [&](Index begin, Index end) {
            for (Index i = begin; i < end; ++i) {
                if (isFixed[i]) continue;
                const Eigen::RowVector3d x = X.row(i);
                Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
                for (Index k = graph.firstFace[i]; k < graph.firstFace[i + 1]; ++k) {
                    const int f = graph.faceAt[k];
                    sum += pulls.row(f) - N.row(f).dot(x) * N.row(f);
                }
                X.row(i) += sum / static_cast<double>(graph.firstFace[i + 1] - graph.firstFace[i]);
            }
        });
    }
    return X;
}

}  // namespace spectral
