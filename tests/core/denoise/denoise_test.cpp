#include "core/denoise/denoise.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <random>

#include "core/denoise/face_graph.h"
#include "core/denoise/noise_height.h"
#include "core/denoise/normal_filter.h"
#include "core/denoise/vertex_update.h"
#include "core/mesh/measures.h"
#include "core/support/errors.h"
#include "core/support/threads.h"
#include "support/shapes.h"

namespace spectral {
namespace {

using testing::Mesh;

/// Noise of a standard deviation of `edges` mean edges along every axis, thus along the normals.
Mesh withGaussianNoise(Mesh mesh, double edges, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0.0, edges * meanEdgeLength(mesh.V, mesh.F));
    for (Index i = 0; i < mesh.V.rows(); ++i)
        for (int c = 0; c < 3; ++c) mesh.V(i, c) += normal(random);
    return mesh;
}

/// Mean angle between the normals of two shapes, in degrees.
double meanAngle(const Vertices& A, const Vertices& B, const Faces& F) {
    const Normals M = faceNormals(A, F), N = faceNormals(B, F);
    double sum = 0.0;
    for (Index t = 0; t < F.rows(); ++t)
        sum += std::acos(std::clamp(M.row(t).dot(N.row(t)), -1.0, 1.0));
    return sum / static_cast<double>(F.rows()) * 180.0 / kPi;
}

double meanDistance(const Vertices& A, const Vertices& B) {
    return (A - B).rowwise().norm().mean();
}

TEST(Denoise, EstimatesTheHeightOfTheNoise) {
    for (const Mesh& mesh : {testing::icosphere(4), testing::cube(20)})
        for (const double height : {0.1, 0.2, 0.3}) {
            const Mesh noisy = withGaussianNoise(mesh, height, 7);
            const double edge = meanEdgeLength(mesh.V, mesh.F);
            const NoiseEstimate found = estimateNoise(faceGraph(noisy.F, noisy.V.rows()), noisy.V);
            EXPECT_NEAR(found.height, height * edge, 0.2 * height * edge) << height;
            EXPECT_NEAR(found.meanEdge, edge, 0.15 * edge);
        }
}

TEST(Denoise, BringsASphereAndACubeNearTheirOriginals) {
    for (const Mesh& mesh : {testing::icosphere(4), testing::cube(20)}) {
        const Mesh noisy = withGaussianNoise(mesh, 0.2, 3);
        const DenoiseResult result = denoise(noisy.V, noisy.F, {});
        EXPECT_LT(meanAngle(result.V, mesh.V, mesh.F), 0.3 * meanAngle(noisy.V, mesh.V, mesh.F));
        EXPECT_LT(meanDistance(result.V, mesh.V), meanDistance(noisy.V, mesh.V));
        EXPECT_EQ(result.volumes.preserved, 1);
        EXPECT_NEAR(result.volumeAfter, result.volumeBefore, 1e-9 * result.volumeBefore);
    }
}

TEST(Denoise, KeepsTheEdgesOfACube) {
    const Mesh mesh = testing::cube(20);
    const Mesh noisy = withGaussianNoise(mesh, 0.2, 5);
    DenoiseOptions options;
    const double kept = meanAngle(denoise(noisy.V, noisy.F, options).V, mesh.V, mesh.F);
    options.keepCreases = false;
    EXPECT_LT(kept, 0.5 * meanAngle(denoise(noisy.V, noisy.F, options).V, mesh.V, mesh.F));
}

TEST(Denoise, LeavesACleanShapeToTheBit) {
    for (const Mesh& mesh : {testing::icosphere(4), testing::cube(8), testing::blob()}) {
        const DenoiseResult result = denoise(mesh.V, mesh.F, {});
        EXPECT_EQ(result.rounds, 0);
        EXPECT_EQ(result.V, mesh.V);
    }
}

TEST(Denoise, LeavesAFewVerticesAlone) {
    const Mesh box = testing::cube(1);
    EXPECT_EQ(denoise(box.V, box.F, {}).V, box.V);
}

TEST(Denoise, MovesNoVertexFarAmongNeedles) {
    Mesh mesh = testing::cube(12);
    mesh.V.col(0) *= 30.0;
    const Mesh noisy = withGaussianNoise(mesh, 0.1, 1);
    const DenoiseResult result = denoise(noisy.V, noisy.F, {});
    EXPECT_GT(result.rounds, 0);
    const double allowed = std::max(3.0 * result.noiseHeight, 0.3 * result.meanEdge);
    EXPECT_LE(result.maxDisplacement, 1.1 * allowed) << "but for the volume";
}

TEST(Denoise, TurnsFoldedFacesBack) {
    const Mesh mesh = testing::icosphere(4);
    const auto folded = [&](const Vertices& X) {
        const Vertices N = areaNormals(mesh.V, mesh.F);
        return (areaNormals(X, mesh.F).cwiseProduct(N).rowwise().sum().array() < 0.0).count();
    };
    const Mesh noisy = withGaussianNoise(mesh, 0.3, 2);
    ASSERT_GT(folded(noisy.V), 100);
    EXPECT_LT(folded(denoise(noisy.V, noisy.F, {}).V), folded(noisy.V) / 4);
}

TEST(Denoise, KeepsARimUnlessItIsFree) {
    const Mesh mesh = withGaussianNoise(testing::hemisphere(20), 0.2, 1);
    const FaceGraph graph = faceGraph(mesh.F, mesh.V.rows());
    DenoiseOptions options;
    const DenoiseResult fixed = denoise(mesh.V, mesh.F, options);
    options.boundary = Boundary::Free;
    const DenoiseResult free = denoise(mesh.V, mesh.F, options);
    EXPECT_GT(fixed.fixedVertices, 0);
    EXPECT_EQ(free.fixedVertices, 0);
    for (Index i = 0; i < mesh.V.rows(); ++i)
        if (graph.onRim[i]) {
            EXPECT_EQ(fixed.V.row(i), mesh.V.row(i));
            EXPECT_NE(free.V.row(i), mesh.V.row(i));
        }
}

TEST(Denoise, DoesNotCareForOrientation) {
    Mesh mesh = withGaussianNoise(testing::blob(), 0.2, 1);
    const Vertices expected = denoise(mesh.V, mesh.F, {}).V;
    for (Index t = 1; t < mesh.F.rows(); t += 2) std::swap(mesh.F(t, 0), mesh.F(t, 1));
    EXPECT_LT((denoise(mesh.V, mesh.F, {}).V - expected).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Denoise, DoesNotDependOnScalePlaceOrThreads) {
    const Mesh mesh = withGaussianNoise(testing::blob(), 0.2, 1);
    const Vertices expected = denoise(mesh.V, mesh.F, {}).V;
    for (const double scale : {1e-30, 1.0, 1e20}) {
        const Vertices moved = (scale * mesh.V).rowwise() + Eigen::RowVector3d(scale, 0.0, 0.0);
        const Vertices found = denoise(moved, mesh.F, {}).V;
        const Vertices back = (found.rowwise() - Eigen::RowVector3d(scale, 0.0, 0.0)) / scale;
        EXPECT_LT((back - expected).cwiseAbs().maxCoeff(), 1e-6);
    }
    setThreadCount(1);
    const Vertices alone = denoise(mesh.V, mesh.F, {}).V;
    setThreadCount(0);
    EXPECT_EQ(alone, expected);
}

TEST(Denoise, OfStrengthZeroChangesNothingAndOfAGivenHeightTakesThat) {
    const Mesh mesh = withGaussianNoise(testing::blob(), 0.2, 1);
    DenoiseOptions options;
    options.strength = 0.0;
    EXPECT_EQ(denoise(mesh.V, mesh.F, options).V, mesh.V);
    options.strength = 0.5;
    options.noiseHeight = 0.04;
    EXPECT_EQ(denoise(mesh.V, mesh.F, options).noiseHeight, 0.02);
}

TEST(Denoise, AcceptsTrianglesOfAnyKind) {
    Mesh mesh = withGaussianNoise(testing::cube(4), 0.2, 1);
    const Index n = mesh.V.rows(), m = mesh.F.rows();
    mesh.V.conservativeResize(n + 1, 3);
    mesh.V.row(n) << 9, 9, 9;  // unreferenced
    mesh.F.conservativeResize(m + 3, 3);
    mesh.F.row(m) = mesh.F.row(0);                                  // twice
    mesh.F.row(m + 1) << mesh.F(1, 0), mesh.F(1, 0), mesh.F(1, 1);  // a line
    mesh.F.row(m + 2) << mesh.F(2, 0), mesh.F(2, 1), mesh.F(30, 2);
    const DenoiseResult result = denoise(mesh.V, mesh.F, {});
    EXPECT_TRUE(result.V.allFinite());
    EXPECT_EQ(result.V.row(n), mesh.V.row(n));

    const Mesh triangle{mesh.V.topRows(3), (Faces(1, 3) << 0, 1, 2).finished()};
    DenoiseOptions options;
    options.noiseHeight = 0.1;
    for (const Boundary boundary : {Boundary::Fixed, Boundary::Free}) {
        options.boundary = boundary;
        EXPECT_LT((denoise(triangle.V, triangle.F, options).V - triangle.V).norm(), 1e-12);
    }
}

TEST(Denoise, RefusesWhatIsNoStrength) {
    const Mesh mesh = testing::blob();
    DenoiseOptions options;
    options.strength = -1.0;
    EXPECT_THROW(denoise(mesh.V, mesh.F, options), InvalidOption);
    options.strength = 1.0;
    options.noiseHeight = std::nan("");
    EXPECT_THROW(denoise(mesh.V, mesh.F, options), InvalidOption);
    EXPECT_THROW(denoise(mesh.V, Faces(0, 3), {}), InvalidMesh);
}

TEST(NormalFilter, SolvesItsEquation) {
    const Mesh mesh = withGaussianNoise(testing::cube(5), 0.2, 2);
    const FaceGraph graph = faceGraph(mesh.F, mesh.V.rows());
    const NormalFilterOptions options{1.5, 0.3};
    const Normals found = filterNormals(graph, mesh.V, options);

    const Vertices N = areaNormals(mesh.V, mesh.F);
    const Eigen::VectorXd area = N.rowwise().norm();
    Normals q = blurredNormals(graph, N, 2);
    q.rowwise().normalize();
    double meanLength = 0.0;
    for (const auto& edge : graph.edges)
        meanLength += (mesh.V.row(edge.ends[0]) - mesh.V.row(edge.ends[1])).norm() /
                      static_cast<double>(graph.edges.size());
    const Eigen::VectorXd M = (area / area.mean()).cwiseMax(0.05).cwiseSqrt();
    Eigen::MatrixXd A = M.asDiagonal();
    for (const auto& edge : graph.edges) {
        const int a = edge.faces[0], b = edge.faces[1];
        const double w = options.time *
                         (mesh.V.row(edge.ends[0]) - mesh.V.row(edge.ends[1])).norm() / meanLength *
                         std::exp(-(q.row(a) - q.row(b)).squaredNorm() / (2.0 * 0.3 * 0.3));
        A(a, a) += w;
        A(b, b) += w;
        A(a, b) -= w;
        A(b, a) -= w;
    }
    Normals expected = A.ldlt().solve(M.asDiagonal() * faceNormals(mesh.V, mesh.F));
    expected.rowwise().normalize();
    EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), 1e-4);
}

TEST(NormalFilter, LeavesNeedlesWithoutNormals) {
    const Mesh needles{(Vertices(4, 3) << 0, 0, 0, 1, 0, 0, 2, 0, 0, 4, 0, 0).finished(),
                       (Faces(2, 3) << 0, 1, 2, 1, 3, 2).finished()};
    EXPECT_EQ(filterNormals(faceGraph(needles.F, 4), needles.V, {}), Normals::Zero(2, 3));
}

TEST(VertexUpdate, GivesAPlaneItsNormalAndMovesNothingElse) {
    Mesh mesh = testing::rectangle(1, 1, 12, 12);
    const Normals up = faceNormals(mesh.V, mesh.F);
    std::mt19937 random(4);
    std::normal_distribution<double> normal(0.0, 0.02);
    Vertices bumpy = mesh.V;
    for (Index i = 0; i < bumpy.rows(); ++i) bumpy(i, 2) += normal(random);
    std::vector<bool> isFixed(static_cast<std::size_t>(bumpy.rows()), false);
    isFixed[80] = true;
    const Vertices flat = followNormals(faceGraph(mesh.F, bumpy.rows()), bumpy, up, isFixed, 50);
    EXPECT_EQ(flat.row(80), bumpy.row(80));
    EXPECT_EQ(flat.leftCols(2), bumpy.leftCols(2)) << "no drift within the plane";
    EXPECT_LT(meanAngle(flat, mesh.V, mesh.F), 0.2 * meanAngle(bumpy, mesh.V, mesh.F));
}

}  // namespace
}  // namespace spectral
