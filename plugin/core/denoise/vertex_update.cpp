#include "core/denoise/vertex_update.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/support/threads.h"

namespace spectral {

namespace {

/// The weight of each face at each vertex, in the order of graph.faces; sums to 1 at each vertex.
Eigen::VectorXd weightsOfFaces(const FaceGraph& graph, const Points& X) {
    // Altitude over distance is 1.5 for equilateral triangles. With .5, depth maps of a cone
    // lose .1 degrees; triangles across silhouettes and skirts have below .1.
    constexpr double kMinRatio = 0.25;
    Eigen::VectorXd altitude(graph.faceCount());  // squared
    Points centroid(graph.faceCount(), 3);
    const Points N = areaNormals(X, graph.F);
    parallelRows(graph.faceCount(), [&](Index begin, Index end) {
        for (Index f = begin; f < end; ++f) {
            const Eigen::RowVector3d a = X.row(graph.F(f, 0)), b = X.row(graph.F(f, 1)),
                                     c = X.row(graph.F(f, 2));
            centroid.row(f) = (a + b + c) / 3.0;
            const double longest =
                std::max({(a - b).squaredNorm(), (b - c).squaredNorm(), (c - a).squaredNorm()});
            altitude[f] = longest > 0.0 ? N.row(f).squaredNorm() / longest : 0.0;
        }
    });
    Eigen::VectorXd weight(static_cast<Index>(graph.faces.at.size()));
    parallelRows(graph.vertexCount(), [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) {
            const Index first = graph.faces.first[i], count = graph.faces.degree(i);
            for (Index k = first; k < first + count; ++k) {
                const int f = graph.faces.at[k];
                const double distance = (centroid.row(f) - X.row(i)).squaredNorm();
                weight[k] =
                    distance > 0.0 ? std::min(kMinRatio * kMinRatio, altitude[f] / distance) : 0.0;
            }
            auto here = weight.segment(first, count);
            const double sum = here.sum();
            if (sum > 0.0)
                here /= sum;
            else if (count > 0)
                here.setConstant(1.0 / static_cast<double>(count));
        }
    });
    return weight;
}

/// @param step  (vertex, weighted mean of n n^T (c - x), its faces) -> displacement.
template <class Step>
Points follow(const FaceGraph& graph, const Eigen::VectorXd& weight, Points X, const Points& N,
              const std::vector<bool>& mayMove, int sweeps, const Step& step) {
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
                    sum += weight[k] * (height[f] - N.row(f).dot(x)) * N.row(f);
                }
                X.row(i) = x + step(i, sum);
            }
        });
    }
    return X;
}

}  // namespace

Points followNormals(const FaceGraph& graph, Points X, const Points& N,
                     const std::vector<bool>& mayMove, int sweeps) {
    const Eigen::VectorXd weight = weightsOfFaces(graph, X);
    return follow(graph, weight, std::move(X), N, mayMove, sweeps,
                  [](Index, const Eigen::RowVector3d& mean) { return mean; });
}

Points followNormalsAlong(const FaceGraph& graph, Points X, const Points& N, const Points& D,
                          const std::vector<bool>& mayMove, int sweeps) {
    constexpr double kMinShare = 0.3;  // of the faces, seen along D: grazing rays are held back
    const Eigen::VectorXd weight = weightsOfFaces(graph, X);
    Eigen::VectorXd scale(X.rows());
    for (Index i = 0; i < X.rows(); ++i) {
        double squares = 0.0;
        for (Index k = graph.faces.first[i]; k < graph.faces.first[i + 1]; ++k)
            squares += weight[k] * std::pow(N.row(graph.faces.at[k]).dot(D.row(i)), 2);
        scale[i] = std::max(squares, kMinShare);
    }
    return follow(graph, weight, std::move(X), N, mayMove, sweeps,
                  [&](Index i, const Eigen::RowVector3d& mean) -> Eigen::RowVector3d {
                      return mean.dot(D.row(i)) / scale[i] * D.row(i);
                  });
}

}  // namespace spectral
