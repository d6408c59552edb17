#include "core/krylov/pole_selection.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/transfer/transfer_function.h"
#include "support/evaluation.h"

namespace spectral {
namespace {

using testing::Operator;

/// Dimension at which the space of a pole suffices; 1000 if that is more than `most`.
int dimensionWithPole(const Operator& A, const Gain& gain, double pole, int most = 200) {
    ShiftedLdlt ldlt;
    ldlt.factorizeDefinite(A.W, A.D, pole);
    FullSpectrumOptions options;
    options.maxDimension = most;
    const FullSpectrumResult result =
        applyFullSpectrum(A, ShiftInvert(ldlt), {gain}, A.mesh.V, options).front();
    return result.converged ? result.dimension : 1000;
}

TEST(SelectPole, IsNearTheBestOfAllPolesTried) {
    const Operator A(testing::blob());
    for (const auto& options : testing::smoothTransferFunctions())
        for (const double alpha : {1.0, 0.1}) {
            const double cutoff = 6.0;
            const Gain gain = fractionalPower(TransferFunction(options, cutoff), alpha);
            const double pole = selectPole(gain, cutoff, bulkSpectrum(A), 1e-6);
            int best = 200;
            for (const double power : {2, 4, 0, 6, -2, 8, -4, 10, -6, 12})  // the likely ones first
                best = std::min(
                    best, dimensionWithPole(A, gain, std::exp2(power) * cutoff * cutoff, best));
            if (best > 100) continue;  // a cusp, which no pole resolves: all poles are equally bad
            EXPECT_LE(dimensionWithPole(A, gain, pole), best + std::max(6, best / 2))
                << testing::describe(options) << " alpha " << alpha;
        }
}

TEST(SelectPole, ReturnsTheBandWhenItIsTooNarrowToSample) {
    TransferFunctionOptions options;
    options.type = FilterType::BandPass;
    options.bandWidth = 1e-6;
    for (const double cutoff : {1.0, 3.0})
        EXPECT_DOUBLE_EQ(selectPole(fractionalPower(TransferFunction(options, cutoff), 0.5), cutoff,
                                    {0.01, 1e4}, 1e-6),
                         cutoff * cutoff);
}

TEST(SelectPole, SeesABandFarFromTheCutoff) {
    // Two octaves below, where a pole at or above the cutoff has few nodes.
    const Operator A(testing::icosphere(5));
    TransferFunctionOptions options;
    options.type = FilterType::BandPass;
    options.stopGain = 1.0;
    options.passGain = 2.0;
    const Gain gain = fractionalPower(TransferFunction(options, 3.0), 1.0);
    const SpectrumRange range = bulkSpectrum(A);
    const int best = dimensionWithPole(A, gain, selectPole(gain, 3.0, range, 1e-6));
    EXPECT_LE(dimensionWithPole(A, gain, selectPole(gain, 12.0, range, 1e-6)), best + 6);
    EXPECT_LE(dimensionWithPole(A, gain, selectPole(gain, 48.0, range, 1e-6)), best + 6);
}

TEST(SelectPole, IsNotFarOutsideTheSpectrum) {
    // Otherwise (W + lambda_p D)^-1 D is constant to within round-off, and the space invariant.
    const SpectrumRange range{0.01, 1e4};
    for (const auto& options : testing::smoothTransferFunctions())
        for (const double cutoff : {1e-9, 1e9}) {
            const TransferFunction F(options, cutoff);
            const double pole = selectPole(fractionalPower(F, 1.0), cutoff, range, 1e-6);
            EXPECT_GE(pole, 1e-4 * range.lowest) << testing::describe(options);
            EXPECT_LE(pole, 1e2 * range.highest) << testing::describe(options);
        }
}

TEST(SelectPole, ScalesWithTheSquareOfTheFrequency) {
    const double scale = 8.0;
    const TransferFunction F({}, 3.0), scaled({}, 3.0 * scale);
    EXPECT_NEAR(selectPole(fractionalPower(scaled, 0.5), 3.0 * scale,
                           {scale * scale, 1e4 * scale * scale}, 1e-6),
                scale * scale * selectPole(fractionalPower(F, 0.5), 3.0, {1.0, 1e4}, 1e-6), 1e-9);
}

}  // namespace
}  // namespace spectral
