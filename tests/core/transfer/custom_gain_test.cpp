#include "core/transfer/custom_gain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iomanip>
#include <sstream>
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
    EXPECT_NO_THROW(parsed("20:1, 5:2"));
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

/// The built-in responses as expressions.
struct Equivalent {
    TransferFunctionOptions options;
    std::string expression;
};

std::vector<Equivalent> equivalents() {
    std::vector<Equivalent> all(7);
    all[0].expression = "2^(-w^2/2)";
    all[1].options.response = Response::Butterworth;
    all[1].options.order = 4;
    all[1].options.stopGain = 0.25;
    all[1].expression = "0.25 + 0.75/sqrt(1 + w^8)";
    all[2].options.response = Response::Ideal;
    all[2].expression = "w <= 1";
    all[3].options.type = FilterType::HighPass;
    all[3].options.stopGain = 1.0;
    all[3].options.passGain = 2.0;
    all[3].expression = "1 + 2^(-1/(2*w^2))";
    all[4].options.type = FilterType::BandPass;
    all[4].options.stopGain = 1.0;
    all[4].options.passGain = 1.5;
    all[4].expression = "1 + 0.5*2^(-2*log2(w)^2)";
    all[5].options.type = FilterType::BandStop;
    all[5].options.response = Response::Butterworth;
    all[5].expression = "1 - 1/sqrt(1 + (abs(w - 1/w)/(2^0.5 - 2^-0.5))^4)";
    all[6].options.type = FilterType::BandPass;
    all[6].options.response = Response::Ideal;
    all[6].options.stopGain = 1.0;
    all[6].options.passGain = 0.5;
    all[6].expression = "abs(log2(w)) <= 0.5 ? 0.5 : 1";
    return all;
}

TEST(CustomGain, FiltersLikeTheBuiltInResponses) {
    const testing::Mesh mesh = testing::blob();
    const double diagonal = boundingBoxDiagonal(mesh.V);
    for (const Equivalent& equivalent : equivalents()) {
        FilterOptions options;
        options.transferFunction = equivalent.options;
        options.featureSize = 0.3 * diagonal;
        options.steps = 2;
        options.evaluation.accuracy = 1e-9;
        const Vertices expected = fractionalFilter(mesh.V, mesh.F, options).V;

        options.transferFunction = {};
        options.transferFunction.type = FilterType::Custom;
        options.transferFunction.custom =
            parseGain(equivalent.expression, cutoffFrequency(options.featureSize), {}).gain;
        const Vertices actual = fractionalFilter(mesh.V, mesh.F, options).V;
        EXPECT_LT((actual - expected).rowwise().norm().maxCoeff(), 1e-8 * diagonal)
            << equivalent.expression;
    }
}

TEST(CustomGain, PointsFilterLikeTheResponseTheySample) {
    const testing::Mesh mesh = testing::blob();
    const double diagonal = boundingBoxDiagonal(mesh.V);
    FilterOptions options;
    options.featureSize = 0.3 * diagonal;
    options.steps = 2;
    for (const FilterType type :
         {FilterType::LowPass, FilterType::HighPass, FilterType::BandPass, FilterType::BandStop})
        for (const Response response : {Response::Gaussian, Response::Butterworth}) {
            TransferFunctionOptions builtIn;
            builtIn.type = type;
            builtIn.response = response;
            builtIn.passGain = 1.6;
            builtIn.stopGain = 0.4;  // points have no gain of 0
            options.transferFunction = builtIn;
            const Vertices expected = fractionalFilter(mesh.V, mesh.F, options).V;

            const TransferFunction F(builtIn, cutoffFrequency(options.featureSize));
            std::ostringstream points;
            points << std::setprecision(12);
            constexpr int kCount = 1000, kPerOctave = 256;
            for (int i = -kCount; i <= kCount; ++i) {
                const double octaves = -static_cast<double>(i) / kPerOctave;
                const double size = options.featureSize * std::exp2(octaves);
                points << (i > -kCount ? ", " : "") << size << ":" << F(cutoffFrequency(size));
            }
            const CustomGain equalizer = parseGain(points.str(), 1.0, {diagonal, 1.0});
            options.transferFunction = {};
            options.transferFunction.type = FilterType::Custom;
            options.transferFunction.custom = equalizer.gain;
            EXPECT_NEAR(equalizer.cutoff, cutoffFrequency(options.featureSize), 1e-3);
            const FilterResult actual = fractionalFilter(mesh.V, mesh.F, options);
            EXPECT_TRUE(actual.accuracyReached);
            EXPECT_LT((actual.V - expected).rowwise().norm().maxCoeff(), 1e-6 * diagonal)
                << static_cast<int>(type) << ", " << static_cast<int>(response);
        }
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
