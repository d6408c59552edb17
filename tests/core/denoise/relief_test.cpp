#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <utility>

#include "core/denoise/denoise.h"
#include "core/denoise/least_risk.h"
#include "core/graph/face_graph.h"
#include "core/mesh/measures.h"
#include "core/noise/least_height.h"
#include "core/noise/noise_estimate.h"
#include "core/noise/scan_rays.h"
#include "support/noisy_shapes.h"

namespace spectral {
namespace {

using testing::Mesh;

constexpr int kCells = 60;

/// A sheet of squares of one unit with the given height over them.
Mesh sheet(const std::function<double(double, double)>& height, int cells = kCells) {
    Mesh mesh = testing::rectangle(cells, cells, cells, cells);
    for (Index i = 0; i < mesh.V.rows(); ++i) mesh.V(i, 2) = height(mesh.V(i, 0), mesh.V(i, 1));
    return mesh;
}

double wave(double x, double pitch) { return std::cos(2.0 * kPi * x / pitch + 0.3); }
double thread(double x, double pitch) {
    return 4.0 * std::abs(x / pitch - std::floor(x / pitch) - 0.5) - 1.0;
}

/// Mean angle between the normals of the faces, degrees.
double angle(const Mesh& mesh, const Vertices& X) {
    Points M = areaNormals(mesh.V, mesh.F), N = areaNormals(X, mesh.F);
    normalizeRows(M);
    normalizeRows(N);
    return (M.cwiseProduct(N).rowwise().sum().array().min(1.0).max(-1.0).acos()).mean() * 180.0 /
           kPi;
}

/// Part of the relief that is left, away from the rim.
double kept(const Mesh& mesh, const Vertices& X) {
    double products = 0.0, squares = 0.0;
    for (Index i = 0; i < X.rows(); ++i) {
        const auto isInner = [&](double x) { return x > 8.0 && x < kCells - 8.0; };
        if (!isInner(mesh.V(i, 0)) || !isInner(mesh.V(i, 1))) continue;
        products += X(i, 2) * mesh.V(i, 2);
        squares += mesh.V(i, 2) * mesh.V(i, 2);
    }
    return products / squares;
}

TEST(Denoise, RemovesNoiseFromReliefAndKeepsIt) {
    const double s = std::sqrt(0.5);
    for (const double pitch : {6.0, 8.0})
        for (const double height : {0.1, 0.2, 0.3}) {
            const Mesh reliefs[]{
                sheet([&](double x, double) { return 0.5 * wave(x, pitch); }),
                sheet([&](double x, double y) { return 0.5 * thread(x + 0.17 * y, pitch); }),
                sheet([&](double x, double y) {
                    return 0.5 * (wave(s * (x + y), pitch) + wave(s * (x - y), pitch));
                })};
            for (const Mesh& relief : reliefs) {
                Mesh noisy = relief;
                std::mt19937 random(3);
                std::normal_distribution<double> normal(0.0, height);
                for (double& x : noisy.V.reshaped()) x += normal(random);
                const DenoiseResult result = denoise(noisy.V, noisy.F, {});
                EXPECT_GT(kept(relief, result.V), 0.85) << pitch << " " << height;
                EXPECT_LE(angle(relief, result.V), angle(relief, noisy.V))
                    << pitch << " " << height;
            }
        }
}

TEST(Denoise, LeavesCleanReliefAndNaturalGroundBitIdentical) {
    const Mesh ribs = sheet([](double x, double) { return 0.5 * wave(x, 6.0); });
    EXPECT_EQ(denoise(ribs.V, ribs.F, {}).V, ribs.V);
    // Ground as rough at all sizes: waves of random directions whose heights fall with their
    // number.
    for (const double exponent : {0.4, 0.8}) {
        std::mt19937 random(5);
        std::uniform_real_distribution<double> uniform(0.0, 2.0 * kPi);
        constexpr int kWaves = 1500;
        Eigen::VectorXd height = Eigen::VectorXd::Zero((kCells + 1) * (kCells + 1));
        Mesh ground = sheet([](double, double) { return 0.0; });
        for (int k = 0; k < kWaves; ++k) {
            const double number = 0.05 * std::pow(64.0, uniform(random) / (2.0 * kPi));
            const double direction = uniform(random), phase = uniform(random);
            for (Index i = 0; i < height.size(); ++i)
                height[i] += std::pow(number, -exponent) *
                             std::cos(number * (std::cos(direction) * ground.V(i, 0) +
                                                std::sin(direction) * ground.V(i, 1)) +
                                      phase);
        }
        ground.V.col(2) = 0.01 * height;
        EXPECT_EQ(denoise(ground.V, ground.F, {}).V, ground.V) << exponent;
    }
}

TEST(Denoise, LeavesFineReliefOnLargeSheets) {
    // There the octaves fall so far below the relief that all that is fine looks like noise.
    for (const double pitch : {3.0, 3.5, 4.0, 4.5})
        for (const double height : {0.5, 1.0}) {
            const Mesh dimples = sheet(
                [&](double x, double y) { return height * wave(x, pitch) * wave(y, pitch); }, 128);
            EXPECT_EQ(denoise(dimples.V, dimples.F, {}).V, dimples.V) << pitch << " " << height;
            const Mesh knurls =
                sheet([&](double x,
                          double y) { return height * wave(x + y, pitch) * wave(x - y, pitch); },
                      128);
            EXPECT_EQ(denoise(knurls.V, knurls.F, {}).V, knurls.V) << pitch << " " << height;
        }
}

TEST(Denoise, TellsReliefOfAFewEdgesFromNoise) {
    const auto ribs = [](double pitch) {
        return [pitch](double x, double) { return std::clamp(2.0 * wave(x, pitch), -1.0, 1.0); };
    };
    const auto layers = [](double pitch) {
        return [pitch](double x, double) { return std::abs(wave(x, 2.0 * pitch)); };
    };
    const auto knurls = [](double x, double y) {
        const double s = std::sqrt(0.5);
        return wave(s * (x + y), 4.0) * wave(s * (x - y), 4.0);
    };
    for (const double scale : {0.25, 0.5})
        for (const double pitch : {3.0, 4.0, 6.0, 7.0})
            for (const auto& shape : {std::function<double(double, double)>(ribs(pitch)),
                                      std::function<double(double, double)>(layers(pitch)),
                                      std::function<double(double, double)>(knurls)}) {
                const Mesh relief = sheet([&](double x, double y) { return scale * shape(x, y); });
                EXPECT_EQ(denoise(relief.V, relief.F, {}).V, relief.V) << pitch << " " << scale;
            }
    const Mesh relief = sheet([&](double x, double y) { return 0.5 * knurls(x, y); });
    Mesh noisy = relief;
    std::mt19937 random(3);
    std::normal_distribution<double> normal(0.0, 0.2);
    for (Index i = 0; i < noisy.V.rows(); ++i) noisy.V(i, 2) += normal(random);
    const DenoiseResult result = denoise(noisy.V, noisy.F, {});
    EXPECT_NEAR(result.diagnosis.noise.height, 0.2, 0.05);
    EXPECT_GT(kept(relief, result.V), 0.8);
    EXPECT_LT(angle(relief, result.V), 0.8 * angle(relief, noisy.V));
}

TEST(Diagnosis, MeasuresNoiseUnderAShapeThatIsAsHigh) {
    const Mesh steep =
        sheet([](double x, double y) { return 6.0 * wave(x, 30.0) * wave(y, 26.0); });
    const Mesh cells = [] {
        Mesh all = testing::icosphere(2);
        for (int k = 1; k < 30; ++k) {
            Mesh one = testing::icosphere(2);
            one.V.col(0).array() += 3.0 * k;
            all = testing::joined(all, one);
        }
        return all;
    }();
    const auto alongNormals = [](const Mesh& mesh, Mesh noisy) {
        const Points N = smoothVertexNormals(faceGraph(mesh.F, mesh.V.rows()), mesh.V);
        const Eigen::VectorXd heights = (noisy.V - mesh.V).cwiseProduct(N).rowwise().sum();
        noisy.V = mesh.V + heights.asDiagonal() * N;
        return noisy;
    };
    const Mesh all = testing::withGaussianNoise(cells, 0.12, 2);
    for (const auto& [mesh, noisy] :
         {std::pair(steep, testing::withGaussianNoise(steep, 0.12, 2)), std::pair(cells, all),
          std::pair(cells, alongNormals(cells, all))}) {
        const double height = 0.12 * meanEdgeLength(mesh.V, mesh.F);
        const DenoiseResult result = denoise(noisy.V, noisy.F, {});
        EXPECT_EQ(result.diagnosis.kind, NoiseKind::White);
        EXPECT_NEAR(result.diagnosis.noise.height, height, 0.1 * height);
        EXPECT_LT(angle(mesh, result.V), 0.5 * angle(mesh, noisy.V));
    }
}

TEST(LeastHeight, IsThatOfTheNoiseWhateverTheRelief) {
    constexpr double kHeight = 0.1;
    const auto measured = [](const Mesh& mesh, double highest) {
        Mesh noisy = mesh;
        std::mt19937 random(3);
        std::normal_distribution<double> normal(0.0, kHeight);
        for (Index i = 0; i < noisy.V.rows(); ++i) noisy.V(i, 2) += normal(random);
        const FaceGraph graph = faceGraph(noisy.F, noisy.V.rows());
        std::vector<bool> inner(graph.onRim);
        inner.flip();
        const Points N = smoothVertexNormals(graph, noisy.V);
        return std::array{leastHeight(graph, noisy.V, N, inner, highest),
                          secondResiduals(graph, noisy.V, N, inner).height};
    };
    const Mesh flat = sheet([](double, double) { return 0.0; });
    EXPECT_NEAR(measured(flat, 1.0)[0], kHeight, 0.05 * kHeight);
    for (const double pitch : {4.0, 6.0, 8.0}) {
        const Mesh waves = sheet([&](double x, double) { return 0.5 * wave(x, pitch); });
        EXPECT_NEAR(measured(waves, 1.0)[0], kHeight, 0.05 * kHeight) << pitch;
        const Mesh ribs =  // steps of one edge, which alternate as noise does
            sheet([&](double x, double y) { return wave(x + 0.3 * y, pitch) > 0.0 ? 0.5 : 0.0; });
        const auto [height, second] = measured(ribs, 1.0);
        EXPECT_NEAR(height, kHeight, 0.3 * kHeight) << pitch;
        EXPECT_GT(second, 1.3 * height) << pitch;
    }
    // It is never more than what was measured otherwise, also where all filters are one.
    EXPECT_EQ(measured(flat, 0.5 * kHeight)[0], 0.5 * kHeight);
    Mesh tetrahedra;
    tetrahedra.V.resize(4, 3);
    tetrahedra.V << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
    tetrahedra.F.resize(4, 3);
    tetrahedra.F << 0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2;
    for (int k = 0; k < 5; ++k) tetrahedra = testing::joined(tetrahedra, tetrahedra);
    const double height = measured(tetrahedra, 0.5)[0];
    EXPECT_GT(height, 0.0);
    EXPECT_LE(height, 0.5);
}

TEST(Denoise, MakesNoNormalsWorseOnSquareRibs) {
    // Measured 1.85 times as high, the noise would take the normals farther from the truth.
    const Mesh ribs =
        sheet([](double x, double y) { return wave(x + 0.6 * y, 8.0) > 0.0 ? 0.5 : 0.0; });
    Mesh noisy = ribs;
    std::mt19937 random(3);
    std::normal_distribution<double> normal(0.0, 0.1);
    for (Index i = 0; i < noisy.V.rows(); ++i) noisy.V(i, 2) += normal(random);
    const DenoiseResult result = denoise(noisy.V, noisy.F, {});
    EXPECT_NEAR(result.diagnosis.noise.height, 0.1, 0.04);
    EXPECT_LT(angle(ribs, result.V), 0.9 * angle(ribs, noisy.V));
}

TEST(Denoise, LeavesCleanPartsBesideANoisyOneBitIdentical) {
    const Mesh noisy = testing::withGaussianNoise(testing::icosphere(5), 0.15, 4);
    Mesh box = testing::cube(1), fine = testing::cube(12);
    box.V.col(0).array() += 5.0;
    fine.V.col(0).array() -= 5.0;
    const Mesh all = testing::joined(noisy, testing::joined(box, fine));
    const Index n = noisy.V.rows(), others = all.V.rows() - n;
    const DenoiseResult result = denoise(all.V, all.F, {});
    EXPECT_EQ(result.V.bottomRows(others), all.V.bottomRows(others));
    EXPECT_EQ(result.heights.tail(others).cwiseAbs().maxCoeff(), 0.0);
    EXPECT_LT(angle(testing::icosphere(5), result.V.topRows(n)), 3.0);

    // A lake on noisy ground, in noise of one height and of one that grows; and the walls and the
    // bottom of a block under it, whose volume is kept.
    for (const double growth : {0.0, 0.3}) {
        Mesh ground = sheet([](double x, double y) { return 2.0 * wave(x, 40.0) + wave(y, 30.0); });
        const Index top = ground.V.rows();
        const FaceGraph graph = faceGraph(ground.F, top);
        std::mt19937 random(3);
        std::normal_distribution<double> normal(0.0, 0.15);
        std::vector<Index> clean;
        for (Index i = 0; i < top; ++i) {
            const double x = ground.V(i, 0), y = ground.V(i, 1);
            const double fromLake = std::hypot(x - 30.0, y - 20.0);
            const double height = normal(random) * (1.0 - growth + growth * x / 30.0);
            ground.V(i, 2) = fromLake < 8.0 ? -1.0 : ground.V(i, 2) + height;
            if (fromLake < 7.0) clean.push_back(i);
        }
        Mesh bottom = ground;
        bottom.V.col(2).setConstant(-9.0);
        bottom.F.col(1).swap(bottom.F.col(2));
        Mesh block = testing::joined(ground, bottom);
        for (Index i = top; i < block.V.rows(); ++i) clean.push_back(i);
        Index count = block.F.rows();
        block.F.conservativeResize(count + 8 * kCells, 3);
        for (Index f = 0; f < ground.F.rows(); ++f)
            for (int c = 0; c < 3; ++c) {
                if (graph.neighbours(f, c) >= 0) continue;
                const int a = ground.F(f, (c + 1) % 3), b = ground.F(f, (c + 2) % 3),
                          below = static_cast<int>(top);
                block.F.row(count++) << b, a, a + below;
                block.F.row(count++) << b, a + below, b + below;
            }
        ASSERT_EQ(count, block.F.rows());
        const DenoiseResult denoised = denoise(block.V, block.F, {});
        for (const Index i : clean) EXPECT_EQ(denoised.V.row(i), block.V.row(i));
        EXPECT_TRUE(denoised.hasVolume);
        EXPECT_GT(denoised.maxDisplacement, 0.2);
    }
}

TEST(LeastRisk, MovesAlongTheSurfaceOnlyWhereNoiseHasAllDirections) {
    const Mesh ribs = sheet([](double x, double) { return 0.5 * wave(x, 6.0); });
    const FaceGraph graph = faceGraph(ribs.F, ribs.V.rows());
    const std::vector<bool> all = testing::everywhere(ribs.V.rows());
    const Points N = vertexNormals(graph, areaNormals(ribs.V, ribs.F));
    std::mt19937 random(3);
    std::normal_distribution<double> normal(0.0, 0.1);
    Points along = ribs.V, everywhere = ribs.V;
    for (Index i = 0; i < along.rows(); ++i) {
        along.row(i) += normal(random) * N.row(i);
        for (int c = 0; c < 3; ++c) everywhere(i, c) += normal(random);
    }
    const auto slide = [&](const Points& X) {
        const Points change = withLeastRisk(graph, X, all, 0.1) - X;
        const Points smooth = smoothVertexNormals(graph, X, 2);
        const Eigen::VectorXd part = change.cwiseProduct(smooth).rowwise().sum();
        return (change - part.asDiagonal() * smooth).norm() / change.norm();
    };
    EXPECT_LT(slide(along), 1e-12);
    EXPECT_GT(slide(everywhere), 0.5);
    // Nothing moves that may not.
    EXPECT_EQ(withLeastRisk(graph, along, std::vector<bool>(all.size(), false), 0.1), along);
}

TEST(LeastRisk, TakesLessAwayThanTheHeightOfTheNoise) {
    Mesh flat = sheet([](double, double) { return 0.0; });
    flat.V.col(2) = 0.1 * testing::whiteNoise(flat.V.rows());
    const FaceGraph graph = faceGraph(flat.F, flat.V.rows());
    for (const double height : {0.1, 0.2, 0.4}) {
        const Points X = withLeastRisk(graph, flat.V, testing::everywhere(flat.V.rows()), height);
        EXPECT_LT((X - flat.V).norm() / std::sqrt(double(X.rows())), 0.98 * height) << height;
    }
}

TEST(ScanRays, AreTheDirectionOfNoiseOrTheRaysOfPixels) {
    const auto hills = [](double x, double y) { return wave(x, 25.0) + wave(y, 31.0); };
    Mesh scan = sheet(hills);
    const FaceGraph graph = faceGraph(scan.F, scan.V.rows());
    std::vector<bool> inner(graph.onRim);
    inner.flip();
    const Eigen::RowVector3d direction = Eigen::RowVector3d(0.3, -0.2, 1.0).normalized();
    std::mt19937 random(3);
    std::normal_distribution<double> normal(0.0, 0.15);
    Mesh noisy = scan;
    for (Index i = 0; i < noisy.V.rows(); ++i) noisy.V.row(i) += normal(random) * direction;
    const Eigen::RowVector3d inside = scan.V.colwise().mean();
    const ScanRays rays = scanRays(inside, graph, noisy.V, inner, false);
    ASSERT_EQ(rays.direction.rows(), noisy.V.rows());
    EXPECT_FALSE(rays.arePixels);
    EXPECT_GT(std::abs(rays.direction.row(0).dot(direction)), 0.995);
    const Mesh all = testing::withGaussianNoise(scan, 0.15, 4);
    EXPECT_EQ(scanRays(inside, graph, all.V, inner, false).direction.rows(), 0);

    // A camera at the origin: pixels have few slopes.
    Mesh depth = scan;
    for (Index i = 0; i < depth.V.rows(); ++i) {
        const double z = 100.0 + hills(scan.V(i, 0), scan.V(i, 1)) + normal(random);
        depth.V.row(i) << (scan.V(i, 0) - 30.0) / 100.0 * z, (scan.V(i, 1) - 30.0) / 100.0 * z, z;
    }
    const ScanRays pixels = scanRays(Eigen::RowVector3d::Zero(), graph, depth.V, inner, false);
    EXPECT_TRUE(pixels.arePixels);
    EXPECT_LT((pixels.direction - Points(depth.V.rowwise().normalized())).norm(), 1e-9);
}

TEST(Denoise, LeavesVerticesOnASilhouetteInTheirPlace) {
    // A camera at the origin, a box before a wall.
    Mesh truth = sheet([](double x, double y) { return wave(x, 25.0) + wave(y, 31.0); });
    Mesh scan = truth;
    std::vector<bool> isBeforeWall;
    std::mt19937 random(5);
    std::normal_distribution<double> normal(0.0, 0.3);
    for (Index i = 0; i < truth.V.rows(); ++i) {
        const double x = truth.V(i, 0) - 30.0, y = truth.V(i, 1) - 30.0;
        isBeforeWall.push_back(std::max(std::abs(x + 0.2 * y), std::abs(y - 0.2 * x)) < 15.0);
        const double z = 100.0 + truth.V(i, 2) - (isBeforeWall.back() ? 20.0 : 0.0);
        const Eigen::RowVector3d ray(x / 100.0, y / 100.0, 1.0);
        truth.V.row(i) = z * ray;
        scan.V.row(i) = (z + normal(random)) * ray;
    }
    const VertexGraph vertices = faceGraph(scan.F, scan.V.rows()).vertices;
    const DenoiseResult result = denoise(scan.V, scan.F, {});
    Eigen::Array2d before = Eigen::Array2d::Zero(), after = before;  // beside, and on, a silhouette
    for (Index i = 0; i < truth.V.rows(); ++i) {
        int on = 0;
        for (Index k = vertices.first[i]; k < vertices.first[i + 1]; ++k)
            if (isBeforeWall[i] != isBeforeWall[vertices.at[k]]) on = 1;
        before[on] += (scan.V.row(i) - truth.V.row(i)).squaredNorm();
        after[on] += (result.V.row(i) - truth.V.row(i)).squaredNorm();
    }
    EXPECT_LT(std::sqrt(after[0] / before[0]), 0.8);
    EXPECT_LT(std::sqrt(after[1] / before[1]), 1.1);
}

}  // namespace
}  // namespace spectral
