#include "core/transfer/custom_gain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "core/filter/fractional_filter.h"
#include "core/mesh/measures.h"
#include "core/support/errors.h"
#include "core/support/frequency.h"
#include "core/support/types.h"
#include "core/transfer/transfer_function.h"
#include "support/evaluation.h"

namespace spectral {
namespace {

constexpr MeshLengths kLengths{10.0, 0.1};  // diagonal, mean edge
constexpr double kCutoff = 3.0;

CustomGain parsed(const std::string& text) { return parseGain(text, kCutoff, kLengths); }

/// Frequency of details of the given size.
double frequency(double size) { return 2.0 * kPi / size; }

TransferFunction custom(const std::string& text) {
    TransferFunctionOptions options;
    options.type = FilterType::Custom;
    options.custom = parsed(text).gain;
    return TransferFunction(options, kCutoff);
}

std::string messageOf(const std::string& text) {
    try {
        custom(text);
    } catch (const InvalidOption& error) {
        return error.what();
    }
    return "no error";
}

bool mentions(const std::string& message, const std::string& words) {
    return message.find(words) != std::string::npos;
}

TEST(CustomGain, ExpressionsUseRelativeFrequencyFrequencyAndEigenvalue) {
    EXPECT_DOUBLE_EQ(parsed("w").gain(6.0), 2.0);
    EXPECT_DOUBLE_EQ(parsed("f").gain(6.0), 6.0);
    EXPECT_DOUBLE_EQ(parsed("l").gain(6.0), 36.0);
    EXPECT_DOUBLE_EQ(parsed("w < 1 ? 2 : exp(-l)").gain(2.9), 2.0);
    EXPECT_EQ(parsed("w").cutoff, kCutoff);
}

TEST(CustomGain, CopiesEvaluateTheSameExpression) {
    const Gain one = parsed("w^2").gain, other = one;
    EXPECT_EQ(one(6.0), 4.0);
    EXPECT_EQ(other(3.0), 1.0);
    EXPECT_EQ(one(6.0), 4.0);
}

TEST(CustomGain, PointsAreInterpolatedInAnyOrderAndUnit) {
    const CustomGain equalizer = parsed(" 1 % : 0.1, 2:1,6e:2 ");  // sizes 0.1, 2 and 0.6
    EXPECT_NEAR(equalizer.gain(frequency(2.0)), 1.0, 1e-14);
    EXPECT_NEAR(equalizer.gain(frequency(0.6)), 2.0, 1e-14);
    EXPECT_NEAR(equalizer.gain(frequency(0.1)), 0.1, 1e-14);
    EXPECT_EQ(equalizer.gain(frequency(50.0)), 1.0);
    EXPECT_EQ(equalizer.gain(frequency(0.01)), 0.1);
    EXPECT_NEAR(equalizer.cutoff, frequency(std::sqrt(0.2)), 1e-12);
}

TEST(CustomGain, PointsReproduceAPowerOfTheFrequency) {
    const Gain gain = parsed("8:1, 4:2, 2:4, 0.5:16, 0.25:32").gain;
    for (double octave = 1.0; octave <= 4.0; octave += 0.01)
        EXPECT_NEAR(gain(frequency(8.0) * std::exp2(octave)), std::exp2(octave), 1e-12);
}

TEST(CustomGain, PowersOfPointsArePointsOfThePower) {
    const Gain gain = parsed("8:1, 4:2, 1:0.25").gain,
               root = parsed("8:1, 4:1.4142135623730951, 1:0.5").gain;
    for (double size = 10.0; size > 0.5; size *= 0.99)
        EXPECT_NEAR(root(frequency(size)), std::sqrt(gain(frequency(size))), 1e-14);
}

TEST(CustomGain, AGainOfZeroBecomesAThousandth) {
    EXPECT_NEAR(parsed("8:1, 4:0").gain(frequency(3.0)), 1e-3, 1e-15);
}

TEST(CustomGain, ErrorsNameThePositionOfTheMistake) {
    for (const auto& [text, words] :
         std::vector<std::pair<std::string, std::string>>{{"1/(1 + q^2)", "at character 8"},
                                                          {"1/(1 + w", "at character 9"},
                                                          {"", "at character 1"},
                                                          {"5%:1, 2%", "at character 6"},
                                                          {"5%:1, x:2", "at character 6"},
                                                          {"5%:1, 2%:", "at character 10"},
                                                          {"5%:1, 2%:3 4", "at character 10"},
                                                          {"5%:1, -2%:1", "at character 6"},
                                                          {"5%:1,", "at character 6"},
                                                          {"5%:1, 0.5:2", "same size"}})
        EXPECT_TRUE(mentions(messageOf(text), words)) << text << ": " << messageOf(text);
}

TEST(CustomGain, SizesThatAreAllLargerThanTheMeshAreRefused) {
    EXPECT_TRUE(mentions(messageOf("20:1, 12:2"), "did you mean 20%:1, 12%:2?"));
    EXPECT_TRUE(mentions(messageOf("200%:1, 150%:2"), "give smaller ones"));
    for (const char* const text : {"20:1, 5:2", "20:1, 100%:2"})
        EXPECT_NO_THROW(parsed(text)) << text;
}

TEST(CustomGain, WhatIsNotReadAsMathematicsIsRejectedAtItsPosition) {
    for (const auto& [text, words] : std::vector<std::pair<std::string, std::string>>{
             {"0.5<w<1.5", "at character 6, a second comparison"},
             {"w < 1 == 1 ? 2 : 3", "at character 7, a second comparison"},
             {"1 + (2 >= w > 0.5)", "at character 13, a second comparison"},
             {"max(1, 0<w<2)", "at character 11, a second comparison"},
             {"w=1 ? 3 : 4", "at character 2, = assigns"},
             {"1/(w = 2)", "at character 6, = assigns"},
             {"0,5", "at character 2, a comma"},
             {"1/(1+w^2), 0.5", "at character 10, a comma"},
             {"exp(-(0,5*w))", "at character 8, a comma"}})
        EXPECT_TRUE(mentions(messageOf(text), words)) << text << ": " << messageOf(text);
    for (const char* text : {"0.5 < w && w < 1.5", "w<1 ? (w<0.5) : w>2", "(w<1) == (w>2)",
                             "max(w<1, w>2, 3)", "(0.5<w)<1.5", "w != 1 || w == 1"})
        EXPECT_NO_THROW(parsed(text)) << text;
}

TEST(CustomGain, ErrorsNameTheFrequencyOfAnInvalidGain) {
    EXPECT_TRUE(mentions(messageOf("2 - w/4"), "at w = 8.")) << messageOf("2 - w/4");
    EXPECT_TRUE(mentions(messageOf("1/(w - 1)"), "transfer_function is ")) << messageOf("1/(w-1)");
    EXPECT_TRUE(mentions(messageOf("exp(w)"), "transfer_function is inf")) << messageOf("exp(w)");
    EXPECT_TRUE(mentions(messageOf("5%:1, 2%:-1"), "at character 10"));
}

TEST(CustomGain, JumpsAreDetected) {
    EXPECT_TRUE(custom("1/(1 + w^64)").discontinuities().empty());
    EXPECT_TRUE(custom("5%:1, 2%:3, 1%:0").discontinuities().empty());
    const TransferFunction step = custom("w < 1.3 ? 1 : 0.25");
    ASSERT_EQ(step.discontinuities().size(), 1U);
    EXPECT_NEAR(step.discontinuities()[0], 1.3 * kCutoff, 1e-7);
    EXPECT_TRUE(step.isConstantBeyondJumps());
    EXPECT_FALSE(custom("w < 1.3 ? 1 : 0.25 / w").isConstantBeyondJumps());
    EXPECT_EQ(custom("(w > 0.5) * (w < 2)").discontinuities().size(), 2U);
}

TEST(CustomGain, UnsupportedJumpsAreRejectedBeforeAnyWork) {
    const testing::Mesh mesh = testing::blob();
    FilterOptions options;
    options.transferFunction.type = FilterType::Custom;
    options.transferFunction.custom = parsed("w < 1 ? 1 : 0.25/w").gain;
    options.featureSize = frequency(kCutoff);
    options.steps = 1;
    EXPECT_THROW(fractionalFilter(mesh.V, mesh.F, options), InvalidOption);
    options.evaluation.spectrum = Spectrum::Truncated;
    options.evaluation.truncation.basisSize = 40;
    EXPECT_NO_THROW(fractionalFilter(mesh.V, mesh.F, options));
}

}  // namespace
}  // namespace spectral
