#include "core/transfer/sampled_gain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

namespace spectral {
namespace {

using Function = std::function<double(double)>;

Eigen::MatrixXd samplesOf(const Function& gain, int perOctave) {
    constexpr int kOctaves = 4;
    Eigen::MatrixXd samples(2 * kOctaves * perOctave + 1, 2);
    for (Eigen::Index i = 0; i < samples.rows(); ++i) {
        const double w = std::exp2(static_cast<double>(i) / perOctave - kOctaves);
        samples.row(i) << w, gain(w);
    }
    return samples;
}

/// Largest error relative to the gain.
double errorOf(const Function& gain, int perOctave) {
    const SampledGain sampled(samplesOf(gain, perOctave));
    double largest = 0.0;
    for (double octave = -3.0; octave < 2.0; octave += 1e-3) {
        const double w = std::exp2(octave);
        largest = std::max(largest, std::abs(sampled(w) / gain(w) - 1.0));
    }
    return largest;
}

TEST(SampledGain, IsOfThirdOrderOnSmoothGains) {
    const std::vector<Function> gains{
        [](double w) { return 1.0 / (1.0 + std::pow(w, 4.0)); },
        [](double w) { return std::exp(-w * w); },
        [](double w) { return 1.0 + w * w * std::exp(-w * w); },
    };
    for (const Function& gain : gains) {
        EXPECT_LT(errorOf(gain, 128), 2e-6);
        EXPECT_GT(errorOf(gain, 64), 6.0 * errorOf(gain, 128));
    }
}

TEST(SampledGain, DoesNotOvershootAtAJump) {
    const SampledGain sampled(samplesOf([](double w) { return w < 1.0 ? 1.0 : 0.0; }, 128));
    for (double octave = -5.0; octave < 5.0; octave += 1e-3) {
        const double gain = sampled(std::exp2(octave));
        EXPECT_GE(gain, 0.0);
        EXPECT_LE(gain, 1.0);
    }
}

TEST(SampledGain, IsConstantBeyondItsSamples) {
    const SampledGain sampled(samplesOf([](double w) { return 2.0 + 1.0 / w; }, 16));
    EXPECT_EQ(sampled(0.0), sampled(0x1p-4));
    EXPECT_EQ(sampled(1e9), sampled(0x1p4));
}

TEST(SampledGain, IsExactlyOneWhereItsSamplesAre) {
    const SampledGain sampled(samplesOf([](double) { return 1.0; }, 16));
    for (double octave = -5.0; octave < 5.0; octave += 1e-2)
        EXPECT_EQ(sampled(std::exp2(octave)), 1.0);
}

}  // namespace
}  // namespace spectral
