#include "core/denoise/normal_filter.h"

#include <Eigen/IterativeLinearSolvers>
#include <cmath>
#include <vector>

#include "core/mesh/measures.h"
#include "core/support/threads.h"

namespace spectral {

namespace {

/// How often the normals are blurred before the weights are taken from them: with less, the noise
/// makes creases; with more, creases vanish.
constexpr int kBlurs = 2;

/// Of a face, relative to the mean: bounds the condition of the system.
constexpr double kSmallestArea = 0.05;

/// Relative residual of the solves: vertices are within 1e-4 edges of the exact solution.
constexpr double kAccuracy = 1e-5;

/// M + t L.
/// @param N     normals of length twice the area.
/// @param mass  M.
SparseMatrix system(const FaceGraph& graph, const Vertices& X, const Vertices& N,
                    const Eigen::VectorXd& mass, const NormalFilterOptions& options) {
    Normals q = blurredNormals(graph, N, kBlurs);
    normalizeRows(q);
    const auto count = static_cast<Index>(graph.edges.size());
    const double scale = options.time / meanEdgeLength(X, graph.F);
    Eigen::VectorXd weight(count);
    parallelRows(count, [&](Index begin, Index end) {
        for (Index e = begin; e < end; ++e) {
            const auto& [faces, ends] = graph.edges[e];
            const double length = (X.row(ends[0]) - X.row(ends[1])).norm();
            const double distance = (q.row(faces[0]) - q.row(faces[1])).norm() / options.edgeScale;
            weight[e] = scale * length * std::exp(-0.5 * distance * distance);
        }
    });

    Eigen::VectorXd diagonal = mass;
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(static_cast<std::size_t>(2 * count + graph.faceCount()));
    for (Index e = 0; e < count; ++e) {
        const auto& [a, b] = graph.edges[e].faces;
        entries.emplace_back(a, b, -weight[e]);
        entries.emplace_back(b, a, -weight[e]);
        diagonal[a] += weight[e];
        diagonal[b] += weight[e];
    }
    for (Index f = 0; f < graph.faceCount(); ++f)
        entries.emplace_back(static_cast<int>(f), static_cast<int>(f), diagonal[f]);
    SparseMatrix A(graph.faceCount(), graph.faceCount());
    A.setFromTriplets(entries.begin(), entries.end());
    return A;
}

}  // namespace

Normals filterNormals(const FaceGraph& graph, const Vertices& X,
                      const NormalFilterOptions& options) {
    Vertices N = areaNormals(X, graph.F);
    const Eigen::VectorXd area = N.rowwise().norm();
    if (!(area.maxCoeff() > 0.0)) return N;  // needles all, without normals
    const Eigen::VectorXd mass = (area / area.mean()).cwiseMax(kSmallestArea).cwiseSqrt();
    const SparseMatrix A = system(graph, X, N, mass, options);
    normalizeRows(N);
    Normals filtered(N.rows(), 3);
    parallelFor(3, [&](Index c) {
        // Few iterations: the eigenvalues are those of M and 6 t.
        Eigen::ConjugateGradient<SparseMatrix, Eigen::Lower | Eigen::Upper> solver(A);
        solver.setTolerance(kAccuracy);
        filtered.col(c) = solver.solveWithGuess(mass.cwiseProduct(N.col(c)), N.col(c));
    });
    normalizeRows(filtered);
    return filtered;
}

}  // namespace spectral
