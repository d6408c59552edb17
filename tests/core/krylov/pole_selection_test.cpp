#include "core/krylov/pole_selection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <optional>

#include "core/filter/transfer_function.h"
#include "core/laplacian/frequency.h"
#include "support/evaluation.h"

namespace spectral {
namespace {

using testing::Operator;

int dimensionWithPole(const Operator& A, const Gain& gain, double pole) {
    ShiftedLdlt ldlt;
    ldlt.factorizeDefinite(A.laplacian.W, A.laplacian.D, pole);
    const FullSpectrumResult result =
        applyFullSpectrum(A.laplacian.D, A.constants, ldlt, {gain}, A.mesh.V, {}).front();
    return result.converged ? result.dimension : 1000;
}

TEST(SelectPole, IsNearTheBestOfAllPolesTried) {
    const Operator A(testing::blob());
    for (const auto& options : testing::smoothTransferFunctions())
        for (const double alpha : {1.0, 0.1}) {
            const double cutoff = 6.0;
            const Gain gain = fractionalPower(TransferFunction(options, cutoff), alpha);
            const double pole = selectPole(gain, cutoff, bulkSpectrum(A.laplacian), 1e-6).shift;
            int best = 1000;
            for (double power = -6; power <= 12; power += 2)
                best =
                    std::min(best, dimensionWithPole(A, gain, std::exp2(power) * cutoff * cutoff));
            if (best > 100) continue;  // a cusp, which no pole resolves: nothing to choose between
            EXPECT_LE(dimensionWithPole(A, gain, pole), best + std::max(6, best / 2))
                << testing::describe(options) << " alpha " << alpha;
        }
}

TEST(SelectPole, KnowsFromWhichDimensionOnANarrowBandIsSeen) {
    TransferFunctionOptions options;
    options.type = FilterType::BandPass;
    options.stopGain = 1.0;
    options.passGain = 3.0;
    int before = 0;
    for (const double width : {2.0, 0.5, 0.1}) {
        options.bandWidth = width;
        const Gain gain = fractionalPower(TransferFunction(options, 3.0), 1.0);
        const int resolution = selectPole(gain, 3.0, {0.01, 1e4}, 1e-6).resolution;
        EXPECT_GT(resolution, 2 * before) << width;
        before = resolution;
    }
    EXPECT_GT(before, 20);
}

TEST(SufficientDimension, IsEnoughForAnySignal) {
    const Operator A(testing::blob());
    const HarmonicBasis dense = denseBasis(A.laplacian, A.constants);
    std::srand(11);
    Operator noise = A;  // of all frequencies alike, and the shape
    noise.mesh.V.leftCols(2).setRandom();
    int told = 0;
    for (const auto& options : testing::smoothTransferFunctions())
        for (const double alpha : {1.0, 0.25})
            for (const double accuracy : {1e-2, 1e-4, 1e-6}) {
                const Gain gain = fractionalPower(TransferFunction(options, 6.0), alpha);
                const double pole =
                    selectPole(gain, 6.0, bulkSpectrum(A.laplacian), accuracy).shift;
                const std::optional<int> dimension = sufficientDimension(gain, pole, accuracy);
                if (!dimension) continue;
                ++told;
                ShiftedLdlt ldlt;
                ldlt.factorizeDefinite(A.laplacian.W, A.laplacian.D, pole);
                FullSpectrumOptions evaluation;
                evaluation.accuracy = 1e-12;  // never reached
                evaluation.maxDimension = *dimension;
                const FullSpectrumResult result =
                    applyFullSpectrum(A.laplacian.D, A.constants, ldlt, {gain}, noise.mesh.V,
                                      evaluation)
                        .front();
                EXPECT_EQ(result.dimension, *dimension);
                EXPECT_LE(testing::relativeError(
                              noise, result.Y - testing::filteredDense(noise, dense, gain)),
                          accuracy)
                    << testing::describe(options) << " alpha " << alpha << " accuracy " << accuracy;
            }
    EXPECT_GT(told, 50);
}

TEST(SelectPole, ScalesWithTheSquareOfTheFrequency) {
    const double scale = 8.0;
    const TransferFunction F({}, 3.0), scaled({}, 3.0 * scale);
    EXPECT_NEAR(selectPole(fractionalPower(scaled, 0.5), 3.0 * scale,
                           {scale * scale, 1e4 * scale * scale}, 1e-6)
                    .shift,
                scale * scale * selectPole(fractionalPower(F, 0.5), 3.0, {1.0, 1e4}, 1e-6).shift,
                1e-9);
}

}  // namespace
}  // namespace spectral
