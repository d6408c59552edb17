#include "core/denoise/unfold.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

namespace spectral {

namespace {

void sortAndUnique(std::vector<int>& values) {
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
}

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
    std::vector<int> faces(static_cast<std::size_t>(graph.faceCount()));
    std::iota(faces.begin(), faces.end(), 0);
    for (int repetition = 0; repetition < kMaxRepetitions; ++repetition) {
        std::vector<int> corners;
        for (const int f : faces) {
            const Eigen::RowVector3d a = X.row(graph.F(f, 0)), b = X.row(graph.F(f, 1)),
                                     c = X.row(graph.F(f, 2)), now = (b - a).cross(c - a);
            if (now.dot(N.row(f)) >= kMinCosine * now.norm()) continue;
            for (const int i : graph.F.row(f))
                if (mayMove[i]) corners.push_back(i);
        }
        sortAndUnique(corners);
        std::vector<Eigen::RowVector3d> displacements;
        for (const int i : corners) displacements.push_back(displacementToMean(graph, N, X, i));
        faces.clear();  // of the corners: only there can anything have changed
        for (std::size_t k = 0; k < corners.size(); ++k) {
            const int i = corners[k];
            if (displacements[k].norm() <= maxDisplacement[i]) X.row(i) += displacements[k];
            for (Index j = graph.faces.first[i]; j < graph.faces.first[i + 1]; ++j)
                faces.push_back(graph.faces.at[j]);
        }
        sortAndUnique(faces);
    }
}

}  // namespace spectral
