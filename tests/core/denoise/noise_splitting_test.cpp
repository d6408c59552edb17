#include "core/denoise/noise_splitting.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/denoise/denoise.h"
#include "core/mesh/measures.h"
#include "core/noise/noise_estimate.h"
#include "support/noisy_shapes.h"

namespace spectral {
namespace {

using testing::Mesh;

TEST(NoiseSplitting, TellsTheNearerResultWithoutTheTruth) {
    const Mesh clean = testing::icosphere(4), noisy = testing::withGaussianNoise(clean, 0.2, 7);
    const FaceGraph graph = faceGraph(clean.F, clean.V.rows());
    const Points N = smoothVertexNormals(graph, clean.V, 1);
    const double height = 0.2 * meanEdgeLength(clean.V, clean.F);
    const Index n = clean.V.rows();
    const Eigen::VectorXd heights = Eigen::VectorXd::Constant(n, height);
    const SplitNoise split(noisy.V, N, heights);
    const Points error = split.training() - clean.V;
    EXPECT_NEAR(error.cwiseProduct(N).rowwise().sum().norm() / std::sqrt(double(n)),
                SplitNoise::kGrowth * height, 0.05 * height);
    // The truth, half of the noise, and all of it.
    const Points half = clean.V + 0.5 * error;
    EXPECT_GT(split.gain(half, clean.V), 5.0);
    EXPECT_GT(split.gain(split.training(), half), 5.0);
    EXPECT_EQ(split.gain(half, clean.V), -split.gain(clean.V, half));
    // Results that err alike are alike, within the deviation of the estimate.
    EXPECT_LT(std::abs(split.gain(clean.V + 0.1 * height * N, clean.V - 0.1 * height * N)), 4.0);
    // Any numbering of the vertices gives the same.
    const Points reversed = noisy.V.colwise().reverse();
    const SplitNoise other(reversed, N.colwise().reverse(), heights);
    EXPECT_EQ(Points(other.training().colwise().reverse()), split.training());
}

TEST(NoiseSplitting, FlatPartsAreFlattenedAndRoundOnesLeft) {
    const Mesh cube = testing::cube(20), noisy = testing::withGaussianNoise(cube, 0.2, 5);
    EXPECT_LT(testing::meanAngle(denoise(noisy.V, noisy.F, {}).V, cube.V, cube.F), 1.0);
}

}  // namespace
}  // namespace spectral
