#include "core/denoise/normal_filter.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "core/denoise/vertex_update.h"
#include "support/noisy_shapes.h"

namespace spectral {
namespace {

using testing::Mesh;

Points faceNormals(const Points& X, const Faces& F) {
    Points N = areaNormals(X, F);
    normalizeRows(N);
    return N;
}

/// Dense M + t L, for meshes where no local area is below half of the mean.
Eigen::MatrixXd denseSystem(const FaceGraph& graph, const Points& X,
                            const NormalFilterOptions& options, const Eigen::VectorXd& M) {
    Points q = blurredNormals(graph, areaNormals(X, graph.F), options.blurs);
    normalizeRows(q);
    double meanLength = 0.0;
    for (Index f = 0; f < graph.faceCount(); ++f)
        for (int c = 0; c < 3; ++c)
            meanLength += (X.row(graph.F(f, c)) - X.row(graph.F(f, (c + 1) % 3))).norm() /
                          (3.0 * static_cast<double>(graph.faceCount()));
    Eigen::MatrixXd A = M.asDiagonal();
    for (Index a = 0; a < graph.faceCount(); ++a)
        for (int c = 0; c < 3; ++c) {
            const int b = graph.neighbours(a, c);
            if (b < 0) continue;
            const double length =
                (X.row(graph.F(a, (c + 1) % 3)) - X.row(graph.F(a, (c + 2) % 3))).norm();
            const double w = options.time * length / meanLength *
                             std::exp(-(q.row(a) - q.row(b)).squaredNorm() /
                                      (2.0 * options.edgeScale * options.edgeScale));
            A(a, a) += w;
            A(a, b) -= w;
        }
    return A;
}

TEST(NormalFilter, SolvesItsEquation) {
    const Mesh mesh = testing::withGaussianNoise(testing::cube(5), 0.2, 2);
    const FaceGraph graph = faceGraph(mesh.F, mesh.V.rows());
    const Points X = mesh.V, N = faceNormals(X, mesh.F);
    const Eigen::VectorXd area = areaNormals(X, mesh.F).rowwise().norm();
    const Eigen::VectorXd M = (area / area.mean()).cwiseMax(0.05).cwiseSqrt();
    NormalFilterOptions options{1.5, 0.3};
    for (const bool useTwicing : {false, true}) {
        options.useTwicing = useTwicing;
        const Eigen::LDLT<Eigen::MatrixXd> A(denseSystem(graph, X, options, M));
        Points expected = A.solve(M.asDiagonal() * N);
        if (useTwicing) expected += A.solve(M.asDiagonal() * (N - expected)).eval();
        normalizeRows(expected);
        const Points found = filterNormals(graph, X, options);
        EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), 0.03);
        EXPECT_LT((found - expected).norm(), 0.01 * expected.norm());
        // The guess is only where the solver starts; it does not affect the result.
        const Points again = filterNormals(graph, X, options, found);
        EXPECT_LT((again - expected).norm(), 0.01 * expected.norm());
    }
}

TEST(NormalFilter, SmoothsNoiseMoreWhereEdgesAreShort) {
    const Mesh large = testing::rectangle(20.0, 20.0, 20, 20);
    const Mesh small = testing::rectangle(5.0, 5.0, 20, 20);
    Mesh mesh = testing::joined(large, small);
    const double height = 0.1;
    std::mt19937 random(4);
    std::normal_distribution<double> normal(0.0, height);
    for (Index i = 0; i < mesh.V.rows(); ++i) mesh.V(i, 2) = normal(random);
    const FaceGraph graph = faceGraph(mesh.F, mesh.V.rows());
    NormalFilterOptions options{4.0, 0.22};
    const auto slopes = [&] {  // of the large and of the small triangles
        const Points N = filterNormals(graph, mesh.V, options);
        const auto squares = N.leftCols<2>().rowwise().squaredNorm();
        return std::pair(squares.head(large.F.rows()).sum(), squares.tail(small.F.rows()).sum());
    };
    const auto [largeBefore, smallBefore] = slopes();
    const Index m = mesh.F.rows();
    const FacesInNoise noise{Eigen::VectorXd::Ones(m),
                             Eigen::VectorXd::Constant(m, height / meanEdgeLength(mesh.V, mesh.F))};
    options.noise = &noise;
    const auto [largeAfter, smallAfter] = slopes();
    EXPECT_NEAR(largeAfter, largeBefore, 0.02 * largeBefore);
    EXPECT_LT(smallAfter, 0.8 * smallBefore);
}

TEST(NormalFilter, LeavesDegenerateFacesWithoutNormals) {
    Points X(4, 3);
    X << 0, 0, 0, 1, 0, 0, 2, 0, 0, 4, 0, 0;
    Faces F(2, 3);
    F << 0, 1, 2, 1, 3, 2;
    EXPECT_EQ(filterNormals(faceGraph(F, 4), X, {}), Points::Zero(2, 3));
}

TEST(VertexUpdate, FlattensAPlaneWithoutDrift) {
    Mesh mesh = testing::rectangle(1, 1, 12, 12);
    const Points up = faceNormals(mesh.V, mesh.F);
    std::mt19937 random(4);
    std::normal_distribution<double> normal(0.0, 0.02);
    Vertices bumpy = mesh.V;
    for (Index i = 0; i < bumpy.rows(); ++i) bumpy(i, 2) += normal(random);
    std::vector<bool> mayMove = testing::everywhere(bumpy.rows());
    mayMove[80] = false;
    const Vertices flat = followNormals(faceGraph(mesh.F, bumpy.rows()), bumpy, up, mayMove, 50);
    EXPECT_EQ(flat.row(80), bumpy.row(80));
    EXPECT_EQ(flat.leftCols(2), bumpy.leftCols(2)) << "no drift within the plane";
    EXPECT_LT(testing::meanAngle(flat, mesh.V, mesh.F),
              0.2 * testing::meanAngle(bumpy, mesh.V, mesh.F));
}

TEST(VertexUpdate, IsThatOfItsSweeps) {
    const Mesh clean = testing::cube(8), noisy = testing::withGaussianNoise(clean, 0.2, 3);
    const FaceGraph graph = faceGraph(clean.F, clean.V.rows());
    const Points N = faceNormals(clean.V, clean.F);
    std::vector<bool> mayMove = testing::everywhere(clean.V.rows());
    mayMove[7] = false;
    Vertices X = noisy.V;
    for (int sweep = 1; sweep <= 16; ++sweep) {
        const Vertices before = X;
        for (Index i = 0; i < X.rows(); ++i) {
            if (!mayMove[i]) continue;
            const auto count = static_cast<double>(graph.faces.degree(i));
            for (Index k = graph.faces.first[i]; k < graph.faces.first[i + 1]; ++k) {
                const int f = graph.faces.at[k];
                const Eigen::RowVector3d corners = before.row(graph.F(f, 0)) +
                                                   before.row(graph.F(f, 1)) +
                                                   before.row(graph.F(f, 2));
                X.row(i) += N.row(f).dot(corners / 3.0 - before.row(i)) / count * N.row(f);
            }
        }
        const Vertices found = followNormals(graph, noisy.V, N, mayMove, sweep);
        EXPECT_LT((found - X).norm(), 1e-3 * (X - noisy.V).norm());
        EXPECT_EQ(found.row(7), noisy.V.row(7));
    }
}

TEST(VertexUpdate, AlongGrazingLinesIsHeldBack) {
    // A vertex above a plane sees the centroids of its faces at a third of its height. Along a line
    // with the share s of the normal, squared, it goes there at once if s > 0.3, else in part.
    Mesh mesh = testing::rectangle(4, 4, 4, 4);
    Index middle = 0;
    (mesh.V.rowwise() - mesh.V.colwise().mean()).rowwise().norm().minCoeff(&middle);
    mesh.V(middle, 2) = 0.1;
    std::vector<bool> mayMove(static_cast<std::size_t>(mesh.V.rows()), false);
    mayMove[middle] = true;
    const Points N = Eigen::RowVector3d::UnitZ().replicate(mesh.F.rows(), 1);
    for (const double share : {1.0, 0.5, 0.09, 0.01}) {
        const Eigen::RowVector3d line(std::sqrt(1.0 - share), 0.0, std::sqrt(share));
        const Points D = line.replicate(mesh.V.rows(), 1);
        const Points X =
            followNormalsAlong(faceGraph(mesh.F, mesh.V.rows()), mesh.V, N, D, mayMove, 3);
        const double left = 1.0 - 2.0 / 3.0 * std::min(1.0, share / 0.3);
        EXPECT_NEAR(X(middle, 2), 0.1 * std::pow(left, 3), 1e-4) << share;
        EXPECT_LT((X - mesh.V).row(middle).cross(line).norm(), 1e-15) << share;
    }
}

}  // namespace
}  // namespace spectral
