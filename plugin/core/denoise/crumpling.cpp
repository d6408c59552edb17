#include "core/denoise/crumpling.h"

#include <algorithm>

#include "core/support/threads.h"

namespace spectral {

namespace {

/// Share of the pairs of neighbouring faces that are folded onto each other.
double foldedShare(const FaceGraph& graph, const Points& X) {
    constexpr double kFolded = -0.5;  // cosine of the angle between the normals
    Points N = areaNormals(X, graph.F);
    normalizeRows(N);
    const Eigen::Array2d sums =
        parallelSum(N.rows(), Eigen::Array2d(0.0, 0.0), [&](Index begin, Index end) {
            Eigen::Array2d sum(0.0, 0.0);
            for (Index f = begin; f < end; ++f)
                for (int c = 0; c < 3; ++c) {
                    const int other = graph.neighbours(f, c);
                    if (other < 0) continue;
                    sum += Eigen::Array2d(N.row(f).dot(N.row(other)) < kFolded ? 1.0 : 0.0, 1.0);
                }
            return sum;
        });
    return sums[1] > 0.0 ? sums[0] / sums[1] : 0.0;
}

/// Share of the vertices that have moved farther than the largest height of their triangles.
double shareMovedFar(const FaceGraph& graph, const Points& X0, const Points& X) {
    const Points N = areaNormals(X0, graph.F);
    Eigen::VectorXd height(N.rows());
    parallelRows(N.rows(), [&](Index begin, Index end) {
        for (Index f = begin; f < end; ++f) {
            double longest = 0.0;
            for (int c = 0; c < 3; ++c)
                longest = std::max(
                    longest, (X0.row(graph.F(f, c)) - X0.row(graph.F(f, (c + 1) % 3))).norm());
            height[f] = longest > 0.0 ? N.row(f).norm() / longest : 0.0;
        }
    });
    const double count = parallelSum(X.rows(), 0.0, [&](Index begin, Index end) {
        double far = 0.0;
        for (Index i = begin; i < end; ++i) {
            double highest = 0.0;
            for (Index k = graph.faces.first[i]; k < graph.faces.first[i + 1]; ++k)
                highest = std::max(highest, height[graph.faces.at[k]]);
            far += (X.row(i) - X0.row(i)).norm() > highest ? 1.0 : 0.0;
        }
        return far;
    });
    return count / static_cast<double>(X.rows());
}

}  // namespace

bool isCrumpled(const FaceGraph& graph, const Points& X0, const Points& X) {
    constexpr double kMaxFolded = 0.01, kMaxMovedFar = 0.4;
    return foldedShare(graph, X) > foldedShare(graph, X0) + kMaxFolded ||
           shareMovedFar(graph, X0, X) > kMaxMovedFar;
}

}  // namespace spectral
