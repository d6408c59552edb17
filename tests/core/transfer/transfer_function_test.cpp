#include "core/transfer/transfer_function.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/mesh/measures.h"
#include "core/support/errors.h"
#include "core/support/types.h"

namespace spectral {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

TransferFunctionOptions options(FilterType type, Response response) {
    TransferFunctionOptions o;
    o.type = type;
    o.response = response;
    return o;
}

TEST(TransferFunction, LowPassPassesZeroAndStopsInfinity) {
    for (const Response r : {Response::Gaussian, Response::Butterworth, Response::Ideal}) {
        const TransferFunction F(options(FilterType::LowPass, r), 3.0);
        EXPECT_EQ(F(0.0), 1.0);
        EXPECT_EQ(F(kInf), 0.0);
    }
}

TEST(TransferFunction, IdealJumpsExactlyAtItsEdges) {
    const TransferFunction low(options(FilterType::LowPass, Response::Ideal), 3.0);
    EXPECT_EQ(low(3.0), 1.0);
    EXPECT_EQ(low(3.0 + 1e-9), 0.0);
    EXPECT_EQ(low.discontinuities(), std::vector<double>{3.0});
    const TransferFunction band(options(FilterType::BandPass, Response::Ideal), 3.0);
    const std::vector<double> edges = band.discontinuities();
    ASSERT_EQ(edges.size(), 2u);
    EXPECT_NEAR(edges[1] / edges[0], 2.0, 1e-15);
    EXPECT_EQ(band(0.999 * edges[0]), 0.0);
    EXPECT_EQ(band(1.001 * edges[0]), 1.0);
    EXPECT_EQ(band(1.001 * edges[1]), 0.0);
}

TEST(TransferFunction, SmoothResponsesHaveNoDiscontinuity) {
    EXPECT_TRUE(TransferFunction({}, 1.0).discontinuities().empty());
    TransferFunctionOptions flat = options(FilterType::BandPass, Response::Ideal);
    flat.passGain = flat.stopGain = 1.0;
    EXPECT_TRUE(TransferFunction(flat, 1.0).discontinuities().empty());
}

TEST(TransferFunction, APartialFilterIsAPowerOfTheWhole) {
    for (const FilterType type : {FilterType::LowPass, FilterType::BandPass, FilterType::BandStop})
        for (const double stop : {type == FilterType::BandStop ? 0.025 : 0.0, 0.4}) {
            TransferFunctionOptions o = options(type, Response::Gaussian);
            o.passGain = 2.5;
            o.stopGain = stop;
            const TransferFunction whole(o, 2.0);
            o.power = 0.3;
            const TransferFunction part(o, 2.0);
            for (const double omega : {0.5, 1.0, 2.5, 9.0}) {
                EXPECT_NEAR(part(omega), std::pow(whole(omega), 0.3), 1e-14);
                EXPECT_NEAR(part.power(omega, 0.5), std::pow(whole(omega), 0.15), 1e-14);
                EXPECT_EQ(part.whole()(omega), whole(omega));
            }
        }
}

TEST(TransferFunction, FractionalPowersOfABandStopHaveNoZero) {
    for (const Response response : {Response::Gaussian, Response::Butterworth}) {
        TransferFunctionOptions o = options(FilterType::BandStop, response);
        o.passGain = 2.0;
        const TransferFunction zero(o, 1.0);
        EXPECT_EQ(zero(1.0), 0.0);
        EXPECT_NEAR(zero.power(1.0, 0.1), std::pow(0.02, 0.1), 1e-14);
        EXPECT_NEAR(zero.power(30.0, 0.1), std::pow(zero(30.0), 0.1), 1e-4);
    }
    const TransferFunction ideal(options(FilterType::BandStop, Response::Ideal), 1.0);
    EXPECT_EQ(ideal.power(1.0, 0.1), 0.0);
}

TEST(TransferFunction, FractionalPowersSurviveWhereTheGainUnderflows) {
    const TransferFunction gaussian({}, 1.0);
    EXPECT_EQ(gaussian(60.0), 0.0);
    EXPECT_NEAR(gaussian.power(60.0, 0.01) / std::exp2(-18.0), 1.0, 1e-12);
    TransferFunctionOptions steep = options(FilterType::LowPass, Response::Butterworth);
    steep.order = 64;
    EXPECT_NEAR(TransferFunction(steep, 1.0).power(1000.0, 0.01) / std::pow(1000.0, -0.64), 1.0,
                1e-12);
    for (const FilterType type : {FilterType::LowPass, FilterType::HighPass, FilterType::BandPass})
        for (const Response response : {Response::Gaussian, Response::Butterworth})
            for (const double omega : {0.0, 0.3, 1.0, 4.0, kInf}) {
                TransferFunctionOptions o = options(type, response);
                o.passGain = 2.0;
                const TransferFunction F(o, 1.0);
                EXPECT_NEAR(F.power(omega, 0.5), std::sqrt(F(omega)), 1e-14);
            }
}

TEST(TransferFunction, SmallGainsDoNotSufferFromCancellation) {
    // With a pass gain of 0, a band-stop passes only its band.
    for (const Response r : {Response::Gaussian, Response::Butterworth}) {
        TransferFunctionOptions band = options(FilterType::BandPass, r);
        TransferFunctionOptions stop = options(FilterType::BandStop, r);
        stop.passGain = 0.0;
        stop.stopGain = 1.0;
        for (const double x : {1e-8, 1e-3, 0.5, 1.0, 2.0, 1e3, 1e8})
            EXPECT_EQ(TransferFunction(stop, 1.0).power(x, 0.01),
                      TransferFunction(band, 1.0).power(x, 0.01));
    }
    TransferFunctionOptions high = options(FilterType::LowPass, Response::Butterworth);
    high.passGain = 0.0;
    high.stopGain = 1.0;
    high.order = 1;
    EXPECT_NEAR(TransferFunction(high, 1.0)(1e-7) / (0.5 * 1e-14), 1.0, 1e-9);
}

// The fuzzer spoils the options.
TEST(TransferFunction, RejectsAnInvalidCutoff) {
    for (const double cutoff : {0.0, -1.0, kInf, std::nan("")})
        EXPECT_THROW(TransferFunction({}, cutoff), InvalidOption);
}

TEST(MeanGain, IsExactAcrossTheJumpOfAnIdealFilter) {
    const TransferFunction F(options(FilterType::LowPass, Response::Ideal), 3.0);
    EXPECT_NEAR(meanGain(F, 1.0, 9.0), 2.0 / 8.0, 1e-8);
    EXPECT_NEAR(meanGain(F, 4.0, 9.0), 0.0, 1e-12);
}

TEST(MeanGain, AgreesWithTheErrorFunctionForAGaussian) {
    // The integral of 2^(-x^2/2) is sqrt(pi / (2 ln 2)) erf(x sqrt(ln 2 / 2)).
    const TransferFunction F({}, 2.0);
    const double ln2 = std::log(2.0);
    const auto integral = [&](double omega) {
        return 2.0 * std::sqrt(kPi / (2.0 * ln2)) * std::erf(omega / 2.0 * std::sqrt(ln2 / 2.0));
    };
    for (const auto& [from, to] : {std::pair{0.0, 1.0}, {0.5, 4.0}, {1.0, 1000.0}})
        EXPECT_NEAR(meanGain(F, from, to), (integral(to) - integral(from)) / (to - from), 1e-9);
}

TEST(DefaultFeatureSize, IsSixEdgesOrATwentiethOfTheDiagonal) {
    EXPECT_DOUBLE_EQ(defaultFeatureSize(0.01, 10.0), 0.06);
    EXPECT_DOUBLE_EQ(defaultFeatureSize(0.2, 10.0), 0.5);
    EXPECT_DOUBLE_EQ(defaultFeatureSize(0.0, 10.0), 0.5);
    EXPECT_DOUBLE_EQ(defaultFeatureSize(std::numeric_limits<double>::quiet_NaN(), 10.0), 0.5);
}

}  // namespace
}  // namespace spectral
