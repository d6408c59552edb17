#include "core/noise/noise_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/graph/local_average.h"
#include "core/noise/diagnosis.h"
#include "core/support/threads.h"
#include "support/noisy_shapes.h"

namespace spectral {
namespace {

using testing::Mesh;

NoiseField fieldOf(const Mesh& mesh) {
    const FaceGraph graph = faceGraph(mesh.F, mesh.V.rows());
    const std::vector<bool> all = testing::everywhere(mesh.V.rows());
    return measureNoiseField(graph, mesh.V, all, localResiduals(graph, mesh.V, all));
}

TEST(LocalAverage, FastDiffusionIsLazyDiffusion) {
    const Mesh mesh = testing::blob();
    const FaceGraph graph = faceGraph(mesh.F, mesh.V.rows());
    for (const int steps : {1, 2, 8, 32, 128}) {
        const Eigen::VectorXd noise = testing::whiteNoise(mesh.V.rows());
        Eigen::VectorXd expected = noise, fast = noise;
        for (int k = 0; k < steps; ++k) diffuse(graph.vertices, expected);
        diffuseFast(graph.vertices, steps, fast);
        EXPECT_LT((fast - expected).cwiseAbs().maxCoeff(), 1e-3 * noise.cwiseAbs().maxCoeff());
        Eigen::VectorXd ones = Eigen::VectorXd::Ones(mesh.V.rows());
        diffuseFast(graph.vertices, steps, ones);
        EXPECT_LT((ones.array() - 1.0).abs().maxCoeff(), 1e-12);
    }
}

TEST(LocalAverage, ChebyshevCoefficientsAreThoseOfTheirPolynomial) {
    for (const int steps : {1, 3, 24})
        for (const double t : {-1.0, -0.3, 0.5, 1.0}) {
            double sum = 0.0;
            const std::vector<double> coefficients = diffusionCoefficients(steps);
            for (std::size_t j = 0; j < coefficients.size(); ++j)
                sum += coefficients[j] * std::cos(static_cast<double>(j) * std::acos(t));
            EXPECT_NEAR(sum, std::pow(0.5 + 0.5 * t, steps), 5e-4) << steps << " " << t;
        }
}

TEST(LocalAverage, DeviationIsThatOfItsPlaceAndIgnoresOutliers) {
    const Mesh mesh = testing::icosphere(5);
    const FaceGraph graph = faceGraph(mesh.F, mesh.V.rows());
    const std::vector<bool> all = testing::everywhere(mesh.V.rows());
    Eigen::VectorXd noise = testing::whiteNoise(mesh.V.rows());
    std::mt19937 random(1);
    for (Index i = 0; i < noise.size(); ++i) {
        if (mesh.V(i, 2) < 0.0) noise[i] *= 0.1;
        if (random() % 100 == 0) noise[i] = 1000.0;
    }
    const Eigen::VectorXd found = LocalAverage(graph.vertices, all, 32).deviation(noise);
    for (Index i = 0; i < noise.size(); ++i) {
        if (std::abs(mesh.V(i, 2)) < 0.5) continue;
        const double expected = mesh.V(i, 2) > 0.0 ? 1.1 : 0.11;
        EXPECT_NEAR(found[i], expected, 0.5 * expected);
    }
}

TEST(NoiseField, HasTheQuantilesOfItsHeightsInEdges) {
    const Mesh mesh = testing::icosphere(4);
    const Index n = mesh.V.rows();
    const double edge = meanEdgeLength(mesh.V, mesh.F);
    // From 0 to 1 edge: a tenth of them is lower than the lowest, 2 % are higher than the highest.
    const NoiseField field = NoiseField::ofHeights(faceGraph(mesh.F, n), mesh.V,
                                                   Eigen::VectorXd::LinSpaced(n, 0.0, edge));
    EXPECT_NEAR(field.lowest, 0.1, 0.02);
    EXPECT_NEAR(field.median, 0.5, 0.1);
    EXPECT_NEAR(field.highest, 0.98, 0.1);
    EXPECT_NEAR(field.share, 1.0, 1e-3);
    EXPECT_NEAR(field.height[n - 1], edge, 1e-12);
}

TEST(NoiseField, IsTheHeightOfThePlaceAndZeroWhereThereIsNone) {
    for (const double height : {0.15, 0.2, 0.4})
        for (const Mesh& shape : {testing::icosphere(5), testing::cube(30)}) {
            const double edge = meanEdgeLength(shape.V, shape.F), middle = shape.V.col(2).mean();
            const NoiseField field = fieldOf(testing::noisyAbove(shape, middle, height, 3));
            ASSERT_TRUE(field.isAny());
            EXPECT_NEAR(field.share, 0.5, 0.06);
            double sum = 0.0, count = 0.0, wrong = 0.0;
            for (Index i = 0; i < shape.V.rows(); ++i) {
                const double above = (shape.V(i, 2) - middle) / edge;
                if (above < -8.0) wrong += field.height[i] != 0.0;
                if (above > 4.0) sum += field.height[i];
                if (above > 4.0) count += 1.0;
            }
            EXPECT_EQ(wrong, 0.0);
            EXPECT_NEAR(sum / count, height * edge, 0.12 * height * edge);
        }
}

TEST(NoiseField, IsNowhereOnCleanShapes) {
    for (const Mesh& mesh : {testing::icosphere(4), testing::cube(8), testing::cube(20),
                             testing::blob(), testing::torus(2.0, 0.5, 60, 30)})
        EXPECT_FALSE(fieldOf(mesh).isAny());
}

TEST(NoiseField, DoesNotDependOnThreadsScaleOrNumbering) {
    const Mesh mesh = testing::noisyAbove(testing::cube(24), 0.0, 0.2, 5);
    const NoiseField expected = fieldOf(mesh);
    ASSERT_TRUE(expected.isAny());
    {
        const ThreadTeam team(2);
        EXPECT_EQ(fieldOf(mesh).height, expected.height);
    }
    Mesh scaled = mesh;
    scaled.V *= 1e-25;
    EXPECT_LT((fieldOf(scaled).height * 1e25 - expected.height).cwiseAbs().maxCoeff(),
              1e-9 * expected.height.maxCoeff());
    // Reversed numbers change only the white noise that octaves are compared with.
    Mesh reversed{mesh.V.colwise().reverse(),
                  Faces::Constant(mesh.F.rows(), 3, static_cast<int>(mesh.V.rows()) - 1) - mesh.F};
    const NoiseField found = fieldOf(reversed);
    EXPECT_LT((found.height.reverse() - expected.height).norm(), 0.1 * expected.height.norm());
}

TEST(NoiseField, IsMeasuredInEdgesOfThePlace) {
    Mesh both = testing::withGaussianNoise(testing::icosphere(4), 0.2, 1);
    const Index n = both.V.rows(), m = both.F.rows();
    both.V.conservativeResize(2 * n, 3);
    both.V.bottomRows(n) = 0.02 * both.V.topRows(n);
    both.F.conservativeResize(2 * m, 3);
    both.F.bottomRows(m) = both.F.topRows(m).array() + static_cast<int>(n);
    const NoiseField field = fieldOf(both);
    ASSERT_TRUE(field.isAny());
    EXPECT_GT(field.share, 0.98);
    EXPECT_NEAR(field.height.tail(n).mean(), 0.02 * field.height.head(n).mean(),
                0.1 * 0.02 * field.height.head(n).mean());
}

TEST(Diagnosis, TellsNoiseOnAHalfFromSpikes) {
    for (const Mesh& shape : {testing::icosphere(5), testing::cube(32)}) {
        const Index n = shape.V.rows();
        const FaceGraph graph = faceGraph(shape.F, n);
        const double middle = shape.V.col(2).mean();
        for (const double height : {0.12, 0.2, 0.3}) {
            const Mesh mesh = testing::noisyAbove(shape, middle, height, 3);
            const Diagnosis found = diagnose(graph, mesh.V, testing::everywhere(n), false);
            EXPECT_EQ(found.kind, NoiseKind::Local) << n << " " << height;
            EXPECT_EQ(found.spikes, 0) << n << " " << height;
        }
        const Mesh spiky = testing::withSpikes(shape, 0.1, 0.8, 3);
        const Diagnosis spikes = diagnose(graph, spiky.V, testing::everywhere(n), false);
        EXPECT_NE(spikes.kind, NoiseKind::Local) << n;
        EXPECT_GT(spikes.spikes, n / 20) << n;
    }
}

}  // namespace
}  // namespace spectral
