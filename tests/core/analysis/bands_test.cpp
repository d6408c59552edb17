#include "core/analysis/bands.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace spectral {
namespace {

constexpr double kDiagonal = 3.0;

double omegaOf(double featureSize) { return 2.0 * kPi / featureSize; }

/// From twice the diagonal to a 30th of it.
Bands octaves() { return {kDiagonal, omegaOf(2.0 * kDiagonal), omegaOf(kDiagonal / 30.0)}; }

TEST(Bands, AreCentredAtTheDiagonalTimesPowersOfTwo) {
    ASSERT_EQ(octaves().count(), 7);  // 200 % to 3.125 %
    for (int j = 0; j < 7; ++j) {
        EXPECT_DOUBLE_EQ(octaves().featureSize(j), kDiagonal * std::exp2(1 - j));
        EXPECT_NEAR(octaves().edge(j), octaves().featureSize(j) / std::sqrt(2.0), 1e-14);
    }
}

TEST(Bands, FormAPartitionOfUnity) {
    for (double size = 1e-3 * kDiagonal; size < 100.0 * kDiagonal; size *= 1.01) {
        double sum = 0.0;
        for (int j = 0; j < octaves().count(); ++j) {
            const double w = octaves().window(j, omegaOf(size));
            EXPECT_GE(w, 0.0);
            sum += w;
        }
        EXPECT_NEAR(sum, 1.0, 1e-15) << size;
    }
    EXPECT_EQ(octaves().window(0, 0.0), 1.0);
    EXPECT_EQ(octaves().window(6, std::numeric_limits<double>::infinity()), 1.0);
}

TEST(Bands, AreOneAtTheirCentreAndOneHalfAtTheirEdges) {
    for (int j = 0; j + 1 < octaves().count(); ++j) {
        EXPECT_DOUBLE_EQ(octaves().window(j, omegaOf(octaves().featureSize(j))), 1.0);
        const double edge = omegaOf(octaves().edge(j));
        EXPECT_NEAR(octaves().window(j, edge), 0.5, 1e-12);
        EXPECT_NEAR(octaves().window(j + 1, edge), 0.5, 1e-12);
        EXPECT_LT(octaves().window(j, octaves().end(j) * (1.0 + 1e-12)), 1e-20);
        EXPECT_GT(octaves().window(j, octaves().end(j) * 0.99), 0.0);
    }
}

TEST(Bands, AreASingleBandForASingleFrequency) {
    const Bands one(kDiagonal, omegaOf(1.0), omegaOf(1.0));
    EXPECT_EQ(one.count(), 1);
    for (const double omega : {0.0, 1.0, 1e9}) EXPECT_EQ(one.window(0, omega), 1.0);
    EXPECT_EQ(one.end(0), std::numeric_limits<double>::infinity());
}

TEST(Bands, ThirdOctavesFormAPartitionOfUnityAndLieInTheirOctaves) {
    const double lowest = omegaOf(2.0 * kDiagonal), highest = omegaOf(kDiagonal / 30.0);
    const Bands thirds(kDiagonal, lowest, highest, 3);
    ASSERT_EQ(thirds.count(), 19);  // 200 % to 3.125 %
    for (double size = 1e-3 * kDiagonal; size < 100.0 * kDiagonal; size *= 1.01) {
        double sum = 0.0;
        for (int t = 0; t < thirds.count(); ++t) sum += thirds.window(t, omegaOf(size));
        EXPECT_NEAR(sum, 1.0, 1e-15) << size;
    }
    for (int t = 0; t < thirds.count(); ++t) {
        EXPECT_NEAR(thirds.featureSize(t), kDiagonal * std::exp2(1.0 - t / 3.0), 1e-12);
        EXPECT_DOUBLE_EQ(thirds.window(t, omegaOf(thirds.featureSize(t))), 1.0);
        EXPECT_EQ(thirds.nearest(thirds.featureSize(t)), t);
        EXPECT_EQ(octaves().nearest(thirds.featureSize(t)), (t + 1) / 3);
    }
    EXPECT_EQ(octaves().nearest(1e3), 0);
    EXPECT_EQ(octaves().nearest(1e-6), 6);
}

}  // namespace
}  // namespace spectral
