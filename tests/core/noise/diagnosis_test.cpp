#include "core/noise/diagnosis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/graph/diffusion.h"
#include "core/graph/robust_statistics.h"
#include "core/noise/spikes.h"
#include "core/noise/stretched_axis.h"
#include "core/noise/voxel_lattice.h"
#include "support/noisy_shapes.h"

namespace spectral {
namespace {

using testing::Mesh;

Diagnosis diagnosed(const Mesh& mesh) {
    return diagnose(faceGraph(mesh.F, mesh.V.rows()), mesh.V, testing::everywhere(mesh.V.rows()),
                    false);
}

TEST(RobustStatistics, IgnoreOutliers) {
    constexpr int kCount = 20000;  // quantiles of the moduli of normal numbers, deviation 2
    std::vector<double> moduli;
    double x = 0.0;
    for (int i = 0; i < kCount; ++i) {
        while (std::erf(x / std::sqrt(2.0)) < (i + 0.5) / kCount) x += 1e-4;
        moduli.push_back(2.0 * x);
    }
    EXPECT_NEAR(medianDeviation(moduli), 2.0, 2e-3);
    EXPECT_NEAR(trimmedDeviation(moduli), 2.0, 2e-3);
    EXPECT_NEAR(quantile(moduli, 0.99), 2.0 * 2.576, 2e-3);
    for (int i = 0; i < kCount; i += 10) moduli[i] = 100.0;
    EXPECT_NEAR(trimmedDeviation(moduli), 2.0, 2e-3);
    EXPECT_EQ(medianDeviation({}), 0.0);
    EXPECT_EQ(trimmedDeviation({}), 0.0);
}

TEST(Diffusion, KeepsConstantsAndProbesAreIndependent) {
    const Mesh mesh = testing::blob();
    const FaceGraph graph = faceGraph(mesh.F, mesh.V.rows());
    Eigen::VectorXd ones = Eigen::VectorXd::Ones(mesh.V.rows());
    diffuse(graph.vertices, ones);
    EXPECT_LT((ones.array() - 1.0).abs().maxCoeff(), 1e-15);
    const Vertices V = testing::icosphere(5).V;
    constexpr int kProbes = 5;
    const auto rows = withProbes<kProbes>(V);
    const Eigen::MatrixXd probes = rows.rightCols<kProbes>();
    EXPECT_EQ(rows.leftCols<3>(), V);
    EXPECT_EQ(probes.cwiseAbs().minCoeff(), 1.0);
    const Eigen::MatrixXd products = probes.transpose() * probes / double(V.rows());
    EXPECT_LT((products - Eigen::MatrixXd::Identity(kProbes, kProbes)).cwiseAbs().maxCoeff(), 0.05);
    EXPECT_LT(probes.colwise().mean().cwiseAbs().maxCoeff(), 0.05);
}

TEST(Diagnosis, MeasuresTheHeightOfWhiteNoise) {
    for (const Mesh& mesh : {testing::icosphere(4), testing::cube(20)})
        for (const double height : {0.1, 0.2, 0.3}) {
            const Diagnosis found = diagnosed(testing::withGaussianNoise(mesh, height, 7));
            const double edge = meanEdgeLength(mesh.V, mesh.F);
            EXPECT_EQ(found.kind, NoiseKind::White);
            EXPECT_NEAR(found.noise.height, height * edge, 0.1 * height * edge) << height;
            EXPECT_EQ(found.noise.size, 1.0);
        }
}

TEST(Diagnosis, MeasuresCorrelatedNoise) {
    Mesh mesh = testing::rectangle(1.0, 1.0, 70, 70);
    const FaceGraph graph = faceGraph(mesh.F, mesh.V.rows());
    Eigen::VectorXd z = testing::whiteNoise(mesh.V.rows());
    for (int k = 0; k < 2; ++k) diffuse(graph.vertices, z);
    mesh.V.col(2) = 0.2 / 70.0 / std::sqrt(z.squaredNorm() / double(z.size())) * z;
    std::vector<bool> isMeasured(graph.onRim);
    isMeasured.flip();
    const Diagnosis found = diagnose(graph, mesh.V, isMeasured, true);
    EXPECT_GT(found.noise.size, 1.2);
    EXPECT_LT(found.noise.size, 3.0);
    EXPECT_NEAR(found.noise.height, 0.2 / 70.0, 0.45 * 0.2 / 70.0);
    EXPECT_GT(found.noise.correlation, 0.0);
}

TEST(Diagnosis, FindsNoNoiseInCleanShapes) {
    for (const Mesh& mesh : {testing::icosphere(4), testing::cube(20), testing::blob(),
                             testing::torus(2.0, 0.5, 60, 30)}) {
        const Diagnosis found = diagnosed(mesh);
        EXPECT_TRUE(found.kind == NoiseKind::None || found.kind == NoiseKind::Shape);
        EXPECT_EQ(found.spikes, 0);
        EXPECT_EQ(found.X, Points(mesh.V));
    }
}

TEST(Diagnosis, MeasuresNothingOnATessellationOrFewVertices) {
    Mesh needles = testing::torus(2.0, 0.5, 200, 6);
    EXPECT_EQ(diagnosed(needles).kind, NoiseKind::Tessellation);
    EXPECT_EQ(diagnosed(testing::cube(2)).kind, NoiseKind::TooFew);
}

TEST(Diagnosis, TellsScanLinesFromNeedlesOfCad) {
    for (const double spacing : {3.0, 5.0, 8.0}) {
        Mesh lines = testing::rectangle(60.0, 60.0 * spacing, 60, 60);
        lines.V.col(2) = 3.0 * (lines.V.col(0) / 15.0).array().sin();
        EXPECT_EQ(diagnosed(lines).kind, NoiseKind::Tessellation);
        const Eigen::VectorXd noise = testing::whiteNoise(lines.V.rows());
        lines.V.col(2) += 0.15 * noise;
        const Diagnosis found = diagnosed(lines);
        EXPECT_EQ(found.kind, NoiseKind::ScanLines) << spacing;
        EXPECT_NEAR(found.noise.height, 0.15, 0.03) << spacing;
    }
}

TEST(VoxelLattice, IsNotFoundInOtherMeshes) {
    const Mesh ball = testing::segmentedBall(10);
    EXPECT_FALSE(coordinateGrid(SortedPoints(testing::withGaussianNoise(ball, 0.2, 1).V)));
    EXPECT_FALSE(coordinateGrid(SortedPoints(testing::icosphere(4).V)));
    EXPECT_FALSE(voxelLattice(SortedPoints(testing::cube(20).V)));
    const auto found = diagnosed(ball);
    // Marching tetrahedra also put vertices on diagonals, which are not grid edges.
    EXPECT_NE(found.kind, NoiseKind::White);
}

/// Vertices of marching cubes, which are on grid edges, at a level between 0 and 1, on a ball whose
/// voxels are of so many cells.
Points verticesOfMarchingCubes(double level, const Eigen::RowVector3i& cells) {
    std::vector<Eigen::RowVector3d> vertices;
    const Eigen::RowVector3i radius = 6 * cells;
    const auto isInside = [&](const Eigen::RowVector3i& at) {
        const Eigen::RowVector3i p = (at + 8 * cells).array() / cells.array() - 8;
        return p.squaredNorm() < 30;
    };
    for (int x = -radius[0]; x <= radius[0]; ++x)
        for (int y = -radius[1]; y <= radius[1]; ++y)
            for (int z = -radius[2]; z <= radius[2]; ++z) {
                const Eigen::RowVector3i here(x, y, z);
                for (int c = 0; c < 3; ++c) {
                    const Eigen::RowVector3i next = here + Eigen::RowVector3i::Unit(c);
                    if (isInside(here) == isInside(next)) continue;
                    vertices.emplace_back(here.cast<double>());
                    vertices.back()[c] += isInside(here) ? level : 1.0 - level;
                }
            }
    Points X(static_cast<Index>(vertices.size()), 3);
    for (Index i = 0; i < X.rows(); ++i) X.row(i) = vertices[i];
    return X;
}

TEST(VoxelLattice, ReturnsTheVoxelSizeAlongEachAxis) {
    const Eigen::RowVector3d size(0.7, 0.7, 2.1), place(1e3, -5.0, 0.1);
    struct Volume {
        double level;
        Eigen::RowVector3i cells;
    };
    for (const auto& [level, cells] :
         {Volume{0.5, {1, 1, 1}}, Volume{0.47, {1, 1, 1}}, Volume{0.37, {1, 1, 1}},
          Volume{0.9, {1, 1, 1}}, Volume{0.5, {1, 1, 2}}, Volume{0.5, {3, 3, 3}}}) {
        const Points X =
            (verticesOfMarchingCubes(level, cells) * size.asDiagonal()).rowwise() + place;
        const auto lattice = voxelLattice(SortedPoints(X));
        ASSERT_TRUE(lattice) << level << " " << cells;
        EXPECT_LT((lattice->voxel - size.cwiseProduct(cells.cast<double>())).cwiseAbs().maxCoeff(),
                  1e-9)
            << level << " " << cells;
        EXPECT_NEAR(std::pow(lattice->edges, 3), cells.prod(), 1e-9);
    }
    // One vertex off the lattice, and a tenth of them.
    const Points X = verticesOfMarchingCubes(0.5, {1, 1, 1}) * size.asDiagonal();
    for (const Index every : {X.rows(), Index{10}}) {
        Points off = X;
        for (Index i = 0; i < X.rows(); i += every) off.row(i).array() += 0.05 + 1e-4 * double(i);
        const auto found = voxelLattice(SortedPoints(off), false);
        ASSERT_TRUE(found);
        EXPECT_LT((found->voxel - size).cwiseAbs().maxCoeff(), 1e-9);
    }
}

TEST(CoordinateGrid, CoordinatesRoundedToAGridAreNoiseOfKnownHeight) {
    for (const double step : {0.05, 0.1, 0.2}) {
        Mesh mesh = testing::icosphere(5);
        const double edge = meanEdgeLength(mesh.V, mesh.F);
        mesh.V = (mesh.V / (step * edge)).array().round() * step * edge;
        const auto grid = coordinateGrid(SortedPoints(mesh.V));
        ASSERT_TRUE(grid);
        EXPECT_LT((grid->step.array() / (step * edge) - 1.0).abs().maxCoeff(), 1e-9);
        const Diagnosis found = diagnosed(mesh);
        EXPECT_EQ(found.kind, NoiseKind::Rounded) << step;
        EXPECT_NEAR(found.noise.height, step * edge / std::sqrt(12.0), 1e-6 * edge);
        // Rounded on one axis only: not by whoever wrote the file.
        mesh.V.col(1) = testing::icosphere(5).V.col(1);
        EXPECT_NE(diagnosed(mesh).kind, NoiseKind::Rounded) << step;
    }
}

TEST(CoordinateGrid, FacesOfVoxelsAreToldFromDesignedShapes) {
    const Mesh blocks = testing::voxelFaces(10, {1.0, 1.0, 3.0});
    const Diagnosis found = diagnosed(blocks);
    EXPECT_EQ(found.kind, NoiseKind::Voxels);
    EXPECT_LT((found.voxel - Eigen::RowVector3d(1.0, 1.0, 3.0)).norm(), 1e-9);
    for (const int cells : {8, 13, 20}) {
        const NoiseKind kind = diagnosed(testing::cube(cells)).kind;
        EXPECT_TRUE(kind == NoiseKind::None || kind == NoiseKind::Shape);
    }
}

TEST(Spikes, AreFoundWithTheirHeights) {
    const Mesh sphere = testing::icosphere(4);
    const Mesh spiky = testing::withSpikes(sphere, 0.1, 0.8, 3);
    const FaceGraph graph = faceGraph(spiky.F, spiky.V.rows());
    const double edge = meanEdgeLength(sphere.V, sphere.F);
    const Spikes spikes =
        findSpikes(graph, spiky.V, testing::everywhere(spiky.V.rows()), 4.0, edge);
    Index missed = 0, invented = 0;
    for (Index i = 0; i < spiky.V.rows(); ++i) {
        const double height = (spiky.V.row(i) - sphere.V.row(i)).dot(sphere.V.row(i));
        missed += height != 0.0 && std::abs(spikes.height[i] - height) > 0.2 * edge;
        invented += height == 0.0 && std::abs(spikes.height[i]) > 0.1 * edge;
    }
    EXPECT_LT(missed, spikes.count / 20);
    EXPECT_LT(invented, spikes.count / 20);
}

TEST(Spikes, AFewHighOnesAreCertainButCornersAreNot) {
    Mesh sphere = testing::icosphere(4);
    const double edge = meanEdgeLength(sphere.V, sphere.F);
    const Mesh clean = sphere;
    for (const int i : {100, 700, 1500}) sphere.V.row(i) *= 1.0 + 4.0 * edge;
    const Diagnosis found = diagnosed(sphere);
    EXPECT_EQ(found.spikes, 3);
    EXPECT_LT((found.X - Points(clean.V)).rowwise().norm().maxCoeff(), 0.2 * edge);
    EXPECT_EQ(diagnosed(testing::cube(20)).spikes, 0);

    // The top of a pyramid over a hole; its edges are six times as long as those around it.
    Mesh tent = testing::rectangle(20, 20, 20, 20);
    const auto at = [&](double x, double y) {
        Index i = 0;
        while (tent.V(i, 0) != x || tent.V(i, 1) != y) ++i;
        return static_cast<int>(i);
    };
    const int corners[] = {at(6, 6), at(14, 6), at(14, 14), at(6, 14)}, top = at(10, 10);
    Index count = 0;
    for (Index f = 0; f < tent.F.rows(); ++f) {
        const Eigen::MatrixXd fromTop =
            (tent.V(tent.F.row(f), Eigen::all).rowwise() - tent.V.row(top)).cwiseAbs();
        if (fromTop.maxCoeff() > 4.5) tent.F.row(count++) = tent.F.row(f).eval();
    }
    tent.F.conservativeResize(count + 4, 3);
    for (int k = 0; k < 4; ++k) tent.F.row(count + k) << corners[k], corners[(k + 1) % 4], top;
    tent.V(top, 2) = 3.0;
    EXPECT_EQ(diagnosed(tent).spikes, 0);
}

TEST(Spikes, OfThreeNeighboursOnOneSideAreADetail) {
    const Mesh sphere = testing::icosphere(4);
    const double edge = meanEdgeLength(sphere.V, sphere.F);
    const auto found = [&](const std::vector<double>& heights) {  // at the corners of a face
        Mesh mesh = sphere;
        for (int c = 0; c < static_cast<int>(heights.size()); ++c)
            mesh.V.row(sphere.F(900, c)) *= 1.0 + heights[c] * edge;
        return findSpikes(faceGraph(mesh.F, mesh.V.rows()), mesh.V,
                          testing::everywhere(mesh.V.rows()), 4.0, edge)
            .count;
    };
    EXPECT_EQ(found({1.0, 1.0, 1.0}), 0);
    EXPECT_EQ(found({1.0, 1.0}), 2);
}

TEST(Spikes, AreCertainWhereTheyExplainTheResidual) {
    Mesh mesh = testing::icosphere(4);
    const double edge = meanEdgeLength(mesh.V, mesh.F);
    Spikes spikes;
    spikes.N = mesh.V;
    spikes.height.setZero(mesh.V.rows());
    const FaceGraph graph = faceGraph(mesh.F, mesh.V.rows());
    // What is left of a residual is the square of the share of the height that is not explained.
    for (const auto& [i, share] : {std::pair{100, 1.0}, {700, 0.9}, {1500, 0.7}}) {
        mesh.V.row(i) *= 1.0 + 4.0 * edge;
        spikes.height[i] = share * 4.0 * edge;
    }
    const Spikes certain = certainSpikes(graph, mesh.V, spikes, edge);
    EXPECT_EQ(certain.count, 2);
    EXPECT_EQ(certain.height[1500], 0.0);
}

TEST(Diagnosis, ComponentsAreCleanByTheNoiseInTheirOwnEdges) {
    const Mesh coarse = testing::withGaussianNoise(testing::icosphere(4), 0.2, 7);
    const Index n = coarse.V.rows();
    for (const double noise : {0.2, 0.0}) {
        const Mesh fine = testing::withGaussianNoise(testing::icosphere(2), noise, 8);
        Mesh both{Vertices(n + fine.V.rows(), 3), Faces(coarse.F.rows() + fine.F.rows(), 3)};
        both.V << coarse.V, 0.02 * fine.V;
        both.V.bottomRows(fine.V.rows()).col(0).array() += 3.0;
        both.F << coarse.F, fine.F.array() + static_cast<int>(n);
        const Diagnosis found = diagnosed(both);
        const Index clean = std::count(found.isClean.begin(), found.isClean.end(), true);
        EXPECT_EQ(clean, noise > 0.0 ? 0 : fine.V.rows());
    }
}

TEST(StretchedAxis, IsThatOfATerrainButNotOfAClosedSurface) {
    Mesh terrain = testing::rectangle(30, 30, 30, 30);
    terrain.V.col(2) = 100.0 * (terrain.V.col(0) / 4.0).array().sin();
    EXPECT_EQ(stretchedAxis(terrain.F, terrain.V), 2);
    terrain.V.col(2) *= 1e-3;
    EXPECT_EQ(stretchedAxis(terrain.F, terrain.V), std::nullopt);
    // Half of it faces up, half down.
    Mesh needle = testing::icosphere(3);
    needle.V.col(1) *= 1000.0;
    EXPECT_EQ(stretchedAxis(needle.F, needle.V), std::nullopt);
}

}  // namespace
}  // namespace spectral
