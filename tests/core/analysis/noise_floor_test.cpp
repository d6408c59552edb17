#include "core/analysis/noise_floor.h"

#include <gtest/gtest.h>

#include <cmath>

namespace spectral {
namespace {

/// Third octaves of a uniform mesh of unit area: noise energy is proportional to the number of
/// harmonics, which quadruples per octave.
struct Spectrum {
    Eigen::VectorXd size = Eigen::VectorXd(15), amplitude = size, noise = size;

    /// Noise of a given height, and relief of a given height at size 1 that falls by 2^slope per
    /// octave.
    Spectrum(double height, double relief, double slope) {
        for (int b = 0; b < 15; ++b) {
            size[b] = std::exp2((7 - b) / 3.0);
            noise[b] = std::sqrt(0.37) * std::exp2((b - 14) / 3.0);
            amplitude[b] = std::hypot(height * noise[b], relief * std::exp2(slope * (7 - b) / 3.0));
        }
    }

    double sizeOfNoise(double height) const {
        return noiseFeatureSize(height, size, amplitude, noise);
    }
};

TEST(NoiseFeatureSize, IsThatOfAllDetailsOfPureNoise) {
    const Spectrum noise(0.02, 0.0, 1.0);
    EXPECT_NEAR(noise.sizeOfNoise(0.02), noise.size[0], 1e-12);
}

TEST(NoiseFeatureSize, IsWhereReliefFallsBelowTheNoise) {
    // Both are equally high where relief 2^slope(...) = height noise(size), at sizes from 0.6 to 3.
    for (const double slope : {1.5, 2.0, 3.0})
        for (const double octaves : {-0.7, 0.0, 0.8, 1.6}) {
            const double noiseThere = std::sqrt(0.37) * std::exp2(-7.0 / 3.0 - octaves);
            const double relief = 0.02 * noiseThere * std::exp2(-slope * octaves);
            EXPECT_NEAR(std::log2(Spectrum(0.02, relief, slope).sizeOfNoise(0.02)), octaves, 0.2)
                << "slope " << slope << ", " << octaves << " octaves";
        }
}

TEST(NoiseFeatureSize, IsZeroWithoutNoiseOrBandsOrWhereReliefIsHigherEverywhere) {
    EXPECT_EQ(Spectrum(0.0, 1.0, 2.0).sizeOfNoise(0.0), 0.0);
    EXPECT_EQ(noiseFeatureSize(1.0, {}, {}, {}), 0.0);
    EXPECT_EQ(Spectrum(0.0, 1.0, 1.5).sizeOfNoise(1e-3), 0.0);
}

TEST(NoiseFeatureSize, IsFiniteIfABandHasNoEnergy) {
    const Eigen::VectorXd size = Eigen::Vector4d(8, 4, 2, 1), noise = Eigen::Vector4d::Ones();
    const double found = noiseFeatureSize(0.5, size, Eigen::Vector4d(1, 1, 0, 1e-80), noise);
    EXPECT_GT(found, 2.0);
    EXPECT_LT(found, 4.0);
}

}  // namespace
}  // namespace spectral
