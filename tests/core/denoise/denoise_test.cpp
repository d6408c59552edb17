#include "core/denoise/denoise.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "core/denoise/crumpling.h"
#include "core/denoise/linear_steps.h"
#include "core/denoise/removal.h"
#include "core/denoise/whiteness.h"
#include "core/graph/diffusion.h"
#include "core/support/errors.h"
#include "core/support/threads.h"
#include "support/noisy_shapes.h"

namespace spectral {
namespace {

using testing::meanAngle;
using testing::meanDistance;
using testing::Mesh;
using testing::withGaussianNoise;

TEST(Denoise, RestoresASphereAndACube) {
    for (const Mesh& mesh : {testing::icosphere(4), testing::cube(20)}) {
        const Mesh noisy = withGaussianNoise(mesh, 0.2, 3);
        const DenoiseResult result = denoise(noisy.V, noisy.F, {});
        EXPECT_LT(meanAngle(result.V, mesh.V, mesh.F), 0.25 * meanAngle(noisy.V, mesh.V, mesh.F));
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

TEST(Denoise, LeavesACleanShapeBitIdentical) {
    for (const Mesh& mesh : {testing::icosphere(4), testing::cube(8), testing::cube(20),
                             testing::blob(), testing::torus(2.0, 0.5, 200, 6)}) {
        const DenoiseResult result = denoise(mesh.V, mesh.F, {});
        EXPECT_EQ(result.rounds, 0);
        EXPECT_EQ(result.V, mesh.V);
    }
}

TEST(Denoise, RemovesNoiseWhereItIsAndLeavesTheRestBitIdentical) {
    for (const Mesh& mesh : {testing::icosphere(5), testing::cube(30)}) {
        const double middle = mesh.V.col(2).mean(), edge = meanEdgeLength(mesh.V, mesh.F);
        const Mesh noisy = testing::noisyAbove(mesh, middle, 0.2, 3);
        const DenoiseResult result = denoise(noisy.V, noisy.F, {});
        EXPECT_EQ(result.diagnosis.kind, NoiseKind::Local);
        EXPECT_LT(meanAngle(result.V, mesh.V, mesh.F), 0.25 * meanAngle(noisy.V, mesh.V, mesh.F));
        EXPECT_LT(meanDistance(result.V, mesh.V), meanDistance(noisy.V, mesh.V));
        EXPECT_EQ(result.volumes.preserved, 1);
        Index moved = 0;
        for (Index i = 0; i < mesh.V.rows(); ++i)
            if (mesh.V(i, 2) < middle - 8.0 * edge) moved += result.V.row(i) != noisy.V.row(i);
        EXPECT_EQ(moved, 0);
        setThreadCount(1);
        const Vertices alone = denoise(noisy.V, noisy.F, {}).V;
        setThreadCount(0);
        EXPECT_EQ(alone, result.V);
    }
}

TEST(Denoise, RemovesNoiseThatGrowsOverTheShape) {
    Mesh mesh = testing::icosphere(5);
    const Mesh clean = mesh, noisy = withGaussianNoise(mesh, 0.4, 3);
    for (Index i = 0; i < mesh.V.rows(); ++i)
        mesh.V.row(i) += 0.5 * (1.0 + clean.V(i, 2)) * (noisy.V.row(i) - clean.V.row(i));
    const DenoiseResult result = denoise(mesh.V, mesh.F, {});
    EXPECT_EQ(result.diagnosis.kind, NoiseKind::Local);
    EXPECT_LT(meanAngle(result.V, clean.V, mesh.F), 0.15 * meanAngle(mesh.V, clean.V, mesh.F));
}

TEST(Denoise, RemovesNoiseOfDataCoarserThanTheMesh) {
    // The vertices of a coarse sphere, and the midpoints of their edges.
    const Mesh coarse = testing::icosphere(4);
    const auto subdivided = [](const Mesh& from) {
        Mesh mesh = testing::icosphere(5);
        const Index n = from.V.rows();
        const FaceGraph graph = faceGraph(mesh.F, mesh.V.rows());
        const VertexGraph& vertices = graph.vertices;
        mesh.V.topRows(n) = from.V;
        for (Index i = n; i < mesh.V.rows(); ++i) {
            mesh.V.row(i).setZero();
            for (Index k = vertices.first[i]; k < vertices.first[i + 1]; ++k)
                if (vertices.at[k] < n) mesh.V.row(i) += 0.5 * from.V.row(vertices.at[k]);
        }
        return mesh;
    };
    const Mesh clean = subdivided(coarse);
    EXPECT_EQ(denoise(clean.V, clean.F, {}).V, clean.V);
    for (const double height : {0.2, 0.3}) {
        const Mesh noisy = subdivided(testing::withGaussianNoise(coarse, height, 5));
        const DenoiseResult result = denoise(noisy.V, noisy.F, {});
        EXPECT_EQ(result.diagnosis.kind, NoiseKind::Correlated) << height;
        const auto error = [](const Vertices& V) {
            return std::sqrt((V.rowwise().norm().array() - 1.0).square().mean());
        };
        EXPECT_LT(error(result.V), 0.4 * error(noisy.V)) << height;
    }
}

TEST(Denoise, RemovesNoiseFromScanLines) {
    Mesh lines = testing::rectangle(60.0, 300.0, 60, 60);
    lines.V.col(2) = 3.0 * (lines.V.col(0) / 15.0).array().sin();
    const Mesh clean = lines;
    EXPECT_EQ(denoise(lines.V, lines.F, {}).V, lines.V);
    lines.V.col(2) += 0.15 * testing::whiteNoise(lines.V.rows());
    const DenoiseResult result = denoise(lines.V, lines.F, {});
    EXPECT_LT(meanAngle(result.V, clean.V, lines.F), 0.15 * meanAngle(lines.V, clean.V, lines.F));
    EXPECT_LT(meanDistance(result.V, clean.V), 0.7 * meanDistance(lines.V, clean.V));
}

TEST(Denoise, SmoothsFacesOfVoxelsWithinHalfAVoxel) {
    const Eigen::RowVector3d voxel(1.0, 1.0, 3.0);
    const Mesh blocks = testing::voxelFaces(12, voxel);
    const DenoiseResult result = denoise(blocks.V, blocks.F, {});
    EXPECT_EQ(result.diagnosis.kind, NoiseKind::Voxels);
    for (int c = 0; c < 3; ++c)
        EXPECT_LE((result.V - blocks.V).col(c).cwiseAbs().maxCoeff(), 0.5 * voxel[c] + 1e-9);
    Points before = areaNormals(blocks.V, blocks.F), after = areaNormals(result.V, blocks.F);
    double wrongBefore = 0.0, wrongAfter = 0.0;  // angles to the normals of the ball
    for (Index t = 0; t < blocks.F.rows(); ++t) {
        // Normals of an ellipsoid are those of a ball over the squared scale.
        const Eigen::RowVector3d at =
            (blocks.V.row(blocks.F(t, 0)) + blocks.V.row(blocks.F(t, 2))) / 2.0;
        const Eigen::RowVector3d normal =
            (at - 0.5 * voxel).cwiseQuotient(voxel.cwiseAbs2()).normalized();
        wrongBefore += std::acos(std::min(1.0, std::abs(before.row(t).normalized().dot(normal))));
        wrongAfter += std::acos(std::min(1.0, std::abs(after.row(t).normalized().dot(normal))));
    }
    EXPECT_LT(wrongAfter, 0.3 * wrongBefore);
}

TEST(Denoise, RemovesTheStepsOfRoundedCoordinates) {
    const Mesh clean = testing::icosphere(5);
    const double step = 0.1 * meanEdgeLength(clean.V, clean.F);
    Mesh mesh = clean;
    mesh.V = (mesh.V / step).array().round() * step;
    const DenoiseResult result = denoise(mesh.V, mesh.F, {});
    EXPECT_LT(meanAngle(result.V, clean.V, clean.F), 0.3 * meanAngle(mesh.V, clean.V, clean.F));
    EXPECT_LT(meanDistance(result.V, clean.V), meanDistance(mesh.V, clean.V));
}

TEST(Denoise, TreatsFacesWithTwoSidesAsOneSurface) {
    const Mesh mesh = withGaussianNoise(testing::icosphere(4), 0.2, 1);
    Faces twice(2 * mesh.F.rows(), 3);
    twice << mesh.F, mesh.F.rowwise().reverse();
    for (const Boundary boundary : {Boundary::Free, Boundary::Fixed}) {
        DenoiseOptions options;
        options.boundary = boundary;
        EXPECT_EQ(denoise(mesh.V, twice, options).V, denoise(mesh.V, mesh.F, options).V);
    }
}

TEST(Denoise, LeavesATinyMeshAlone) {
    const Mesh box = testing::cube(1);
    EXPECT_EQ(denoise(box.V, box.F, {}).V, box.V);
}

TEST(Denoise, SmoothsVoxelStepsWithinHalfAVoxel) {
    const Mesh ball = testing::segmentedBall(12);
    const FaceGraph graph = faceGraph(ball.F, ball.V.rows());
    RemovalOptions options;
    options.meanEdge = meanEdgeLength(ball.V, ball.F);
    options.mayMove = testing::everywhere(ball.V.rows());
    const Eigen::RowVector3d voxel(1.0, 1.0, 2.0);
    Vertices V = ball.V * voxel.asDiagonal();
    const Vertices smooth =
        removeVoxelSteps(graph, V, voxel, Eigen::Matrix3d::Identity(), 1.5, options, {}).X;
    for (int c = 0; c < 3; ++c)
        EXPECT_LE((smooth - V).col(c).cwiseAbs().maxCoeff(), 0.5 * voxel[c] + 1e-12);
    const auto roughness = [&](const Vertices& X) {
        Points N = areaNormals(X, graph.F);
        normalizeRows(N);
        double sum = 0.0;
        for (Index f = 0; f < N.rows(); ++f)
            for (int c = 0; c < 3; ++c)
                if (graph.neighbours(f, c) >= 0)
                    sum += (N.row(f) - N.row(graph.neighbours(f, c))).squaredNorm();
        return sum;
    };
    EXPECT_LT(roughness(smooth), 0.25 * roughness(V));
}

TEST(Denoise, SmoothsVoxelStepsAlikeWhereTheyAreTurned) {
    Mesh ball = testing::segmentedBall(12);
    ball.V.col(2) *= 2.0;
    const DenoiseResult aligned = denoise(ball.V, ball.F, {});
    ASSERT_EQ(aligned.diagnosis.kind, NoiseKind::Voxels);
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(0.5, Eigen::Vector3d(1.0, -2.0, 0.7).normalized()).toRotationMatrix();
    const Vertices V = ball.V * turn.transpose();
    const DenoiseResult turned = denoise(V, ball.F, {});
    EXPECT_EQ(turned.diagnosis.kind, aligned.diagnosis.kind);
    EXPECT_NEAR(turned.diagnosis.voxel.maxCoeff(), 2.0 * turned.diagnosis.voxel.minCoeff(), 1e-6);
    EXPECT_LT((turned.V - aligned.V * turn.transpose()).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(Denoise, DoesNotCrumpleAMeshOfNeedles) {
    const Mesh needles = testing::torus(2.0, 0.5, 300, 5);
    DenoiseOptions options;
    options.noiseHeight = 0.3 * meanEdgeLength(needles.V, needles.F);
    const DenoiseResult result = denoise(needles.V, needles.F, options);
    EXPECT_TRUE(result.isCrumpled);
    EXPECT_EQ(result.V, needles.V);
    const FaceGraph graph = faceGraph(needles.F, needles.V.rows());
    EXPECT_FALSE(isCrumpled(graph, needles.V, needles.V));
}

TEST(Denoise, HasCrumpledASurfaceWhereOnePercentOfItsEdgesAreFolded) {
    const Mesh mesh = testing::rectangle(20, 20, 20, 20);
    const FaceGraph graph = faceGraph(mesh.F, mesh.V.rows());
    // Vertices that pass their neighbours turn faces over: one of them less than a hundredth.
    const auto isCrumpledBy = [&](int apart) {
        Points X = mesh.V;
        for (Index i = 0; i < X.rows(); ++i) {
            const double x = mesh.V(i, 0), y = mesh.V(i, 1);
            if (std::fmod(x, apart) == 3.0 && std::fmod(y, apart) == 3.0) X(i, 0) += 1.5;
        }
        return isCrumpled(graph, mesh.V, X);
    };
    EXPECT_FALSE(isCrumpledBy(20));
    EXPECT_TRUE(isCrumpledBy(5));
}

TEST(Denoise, UnfoldsFaces) {
    const Mesh mesh = testing::icosphere(4);
    const auto folded = [&](const Vertices& X) {
        const Points N = areaNormals(mesh.V, mesh.F);
        return (areaNormals(X, mesh.F).cwiseProduct(N).rowwise().sum().array() < 0.0).count();
    };
    const Mesh noisy = withGaussianNoise(mesh, 0.3, 2);
    ASSERT_GT(folded(noisy.V), 100);
    EXPECT_LT(folded(denoise(noisy.V, noisy.F, {}).V), folded(noisy.V) / 4);
}

TEST(Denoise, FadesOutAroundASelection) {
    const Mesh mesh = withGaussianNoise(testing::icosphere(5), 0.2, 1);
    DenoiseOptions options;
    for (Index i = 0; i < mesh.V.rows(); ++i) options.selected.push_back(mesh.V(i, 2) > 0.5);
    const DenoiseResult result = denoise(mesh.V, mesh.F, options);
    const double edge = meanEdgeLength(mesh.V, mesh.F);
    for (Index i = 0; i < mesh.V.rows(); ++i) {
        const double moved = (result.V.row(i) - mesh.V.row(i)).norm();
        if (mesh.V(i, 2) < 0.5 - 8.0 * edge) {
            EXPECT_EQ(moved, 0.0);
        }
    }
    // Selected vertices are denoised as in the whole mesh.
    const Vertices whole = denoise(mesh.V, mesh.F, {}).V;
    for (Index i = 0; i < mesh.V.rows(); ++i)
        if (mesh.V(i, 2) > 0.8) {
            EXPECT_LT((result.V.row(i) - whole.row(i)).norm(), 0.1 * edge);
        }
    options.selected.assign(options.selected.size(), false);
    EXPECT_THROW(denoise(mesh.V, mesh.F, options), InvalidOption);
}

TEST(Denoise, DoesNotDependOnOrientation) {
    Mesh mesh = withGaussianNoise(testing::icosphere(4), 0.2, 1);
    const Vertices expected = denoise(mesh.V, mesh.F, {}).V;
    for (Index t = 1; t < mesh.F.rows(); t += 2) std::swap(mesh.F(t, 0), mesh.F(t, 1));
    EXPECT_LT((denoise(mesh.V, mesh.F, {}).V - expected).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Denoise, DoesNotDependOnScalePositionOrThreads) {
    for (const Mesh& shape : {testing::icosphere(4), testing::cube(16)}) {
        const Mesh mesh = withGaussianNoise(shape, 0.2, 1);
        const Vertices expected = denoise(mesh.V, mesh.F, {}).V;
        ASSERT_GT((expected - mesh.V).norm(), 0.0);
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
}

TEST(Denoise, RemovesTheSameNoiseInWhateverWayItIsGiven) {
    for (const Mesh& shape : {testing::icosphere(4), testing::cube(16)}) {
        const Mesh mesh = withGaussianNoise(shape, 0.2, 1);
        const DenoiseResult measured = denoise(mesh.V, mesh.F, {});
        ASSERT_GT(measured.noiseHeight, 0.0);
        DenoiseOptions options;
        options.noiseHeight = measured.noiseHeight;
        options.noiseSize = measured.noiseSize;
        EXPECT_EQ(denoise(mesh.V, mesh.F, options).V, measured.V);
        options.weight.setOnes(mesh.V.rows());
        EXPECT_EQ(denoise(mesh.V, mesh.F, options).V, measured.V);
    }
    const Mesh half = testing::noisyAbove(testing::icosphere(5), 0.0, 0.2, 3);
    const DenoiseResult measured = denoise(half.V, half.F, {});
    ASSERT_EQ(measured.diagnosis.kind, NoiseKind::Local);
    DenoiseOptions options;
    options.noiseHeight = measured.heights.maxCoeff();
    options.weight = measured.heights / options.noiseHeight;
    EXPECT_LT((denoise(half.V, half.F, options).V - measured.V).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(Denoise, AcceptsAnyTriangles) {
    Mesh mesh = withGaussianNoise(testing::cube(6), 0.2, 1);
    const Index n = mesh.V.rows(), m = mesh.F.rows();
    mesh.V.conservativeResize(n + 1, 3);
    mesh.V.row(n) << 9, 9, 9;  // unreferenced
    mesh.F.conservativeResize(m + 3, 3);
    mesh.F.row(m) = mesh.F.row(0);                                  // duplicate
    mesh.F.row(m + 1) << mesh.F(1, 0), mesh.F(1, 0), mesh.F(1, 1);  // degenerate
    mesh.F.row(m + 2) << mesh.F(2, 0), mesh.F(2, 1), mesh.F(30, 2);
    DenoiseOptions options;
    for (const double height : {0.0, 0.05}) {
        options.noiseHeight = height;
        const DenoiseResult result = denoise(mesh.V, mesh.F, options);
        EXPECT_TRUE(result.V.allFinite());
        EXPECT_EQ(result.V.row(n), mesh.V.row(n));
    }

    const Mesh triangle{mesh.V.topRows(3), (Faces(1, 3) << 0, 1, 2).finished()};
    options.noiseHeight = 0.1;
    for (const double size : {0.0, 5.0}) {
        options.noiseSize = size;
        for (const Boundary boundary : {Boundary::Fixed, Boundary::Free}) {
            options.boundary = boundary;
            const Vertices V = denoise(triangle.V, triangle.F, options).V;
            EXPECT_LT((V - triangle.V).norm(), 0.2);
        }
    }
}

TEST(Denoise, DoesNotDependOnTheNumbering) {
    const auto ribs = [] {
        Mesh mesh = testing::rectangle(1.0, 1.0, 48, 48);
        mesh.V.col(2) = 0.02 * (mesh.V.col(0) * 6.0 * kPi).array().sin();
        return mesh;
    };
    const Mesh sphere = testing::icosphere(4), part = testing::cube(20);
    Mesh turned = testing::segmentedBall(10), cut = withGaussianNoise(sphere, 0.2, 4);
    turned.V *= Eigen::AngleAxisd(0.5, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()).matrix();
    // A seam: the faces above a plane have vertices of their own.
    Vertices twice(2 * cut.V.rows(), 3);
    twice << cut.V, cut.V;
    for (auto face : cut.F.rowwise())
        if (cut.V(face.minCoeff(), 2) > 0.0) face.array() += static_cast<int>(cut.V.rows());
    cut.V = twice;
    for (const Mesh& mesh :
         {withGaussianNoise(sphere, 0.2, 3), testing::noisyAbove(part, 0.5, 0.2, 3),
          withGaussianNoise(ribs(), 0.25, 2), testing::withSpikes(sphere, 0.05, 1.5, 5), turned,
          cut, testing::blob()}) {
        std::mt19937 random(1);
        std::vector<int> vertex(static_cast<std::size_t>(mesh.V.rows())),
            face(static_cast<std::size_t>(mesh.F.rows()));
        std::iota(vertex.begin(), vertex.end(), 0);
        std::iota(face.begin(), face.end(), 0);
        std::shuffle(vertex.begin(), vertex.end(), random);
        std::shuffle(face.begin(), face.end(), random);
        Mesh other = mesh;
        for (Index i = 0; i < mesh.V.rows(); ++i) other.V.row(vertex[i]) = mesh.V.row(i);
        for (Index f = 0; f < mesh.F.rows(); ++f)
            for (int c = 0; c < 3; ++c)
                other.F(f, c) = vertex[mesh.F(face[f], (c + f) % 3)];  // corners rotate, too
        const DenoiseResult expected = denoise(mesh.V, mesh.F, {});
        const DenoiseResult found = denoise(other.V, other.F, {});
        EXPECT_EQ(found.diagnosis.kind, expected.diagnosis.kind);
        double largest = 0.0;
        for (Index i = 0; i < mesh.V.rows(); ++i)
            largest = std::max(largest, (found.V.row(vertex[i]) - expected.V.row(i)).norm());
        EXPECT_LT(largest, 1e-6 * meanEdgeLength(mesh.V, mesh.F));
    }
}

TEST(Denoise, RejectsInvalidStrengthHeightAndSize) {
    const Mesh mesh = testing::blob();
    DenoiseOptions options;
    options.strength = -1.0;
    EXPECT_THROW(denoise(mesh.V, mesh.F, options), InvalidOption);
    options.strength = 1.0;
    options.noiseHeight = std::nan("");
    EXPECT_THROW(denoise(mesh.V, mesh.F, options), InvalidOption);
    options.noiseHeight = 0.0;
    options.noiseSize = -1.0;
    EXPECT_THROW(denoise(mesh.V, mesh.F, options), InvalidOption);
    EXPECT_THROW(denoise(mesh.V, Faces(0, 3), {}), InvalidMesh);
}

TEST(Whiteness, IsOneForWhiteNoiseAndLargerForAShape) {
    const Mesh sphere = testing::icosphere(5);
    const VertexGraph graph = faceGraph(sphere.F, sphere.V.rows()).vertices;
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    Eigen::VectorXd white(sphere.V.rows());
    for (double& value : white) value = normal(random);
    EXPECT_NEAR(smoothness(graph, white), 1.0, 0.02);
    EXPECT_NEAR(tail(graph, white), 1.0, 0.05);
    EXPECT_GT(smoothness(graph, sphere.V.col(2)), 1.3);
    white.head(200) *= 20.0;
    EXPECT_GT(tail(graph, white), 1.5);
}

TEST(LinearSteps, DenoiseASphereButNotACube) {
    const auto stepsOf = [](const Mesh& shape) {
        const Mesh noisy = withGaussianNoise(shape, 0.2, 1);
        const FaceGraph graph = faceGraph(noisy.F, noisy.V.rows());
        const double edge = meanEdgeLength(noisy.V, noisy.F);
        const Index n = noisy.V.rows();
        return linearSteps(graph, graph.vertices, noisy.V, testing::everywhere(n),
                           NoiseField::ofHeight(0.2 * edge, edge, n), false);
    };
    EXPECT_EQ(stepsOf(testing::cube(20)).rejected, 1.0);
    const Mesh sphere = testing::icosphere(4);
    const LinearSteps steps = stepsOf(sphere);
    EXPECT_EQ(steps.rejected, 0.0);
    EXPECT_LT(meanAngle(steps.X, sphere.V, sphere.F), 6.0);
}

}  // namespace
}  // namespace spectral
