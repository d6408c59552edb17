#include "core/pole_selection.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/evaluation.h"

namespace spectral {
namespace {

using testing::Operator;

int dimensionWithPole(const Operator& A, const Gain& gain, double pole) {
    ShiftedCholesky cholesky;
    cholesky.factorize(A.laplacian, pole);
    const FullSpectrumResult result =
        applyFullSpectrum(A.laplacian.D, A.constants, cholesky, gain, A.mesh.V, {});
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
