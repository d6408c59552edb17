#include "core/update_candidates.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/harmonic_basis.h"
#include "core/symmetric_product.h"
#include "support/evaluation.h"
#include "support/shapes.h"

namespace spectral {
namespace {

using testing::Operator;

constexpr Index kWanted = 100, kAll = 104;

/// Harmonics but the constant one, of any length.
Eigen::MatrixXd harmonics(const HarmonicBasis& all) { return 2.5 * all.Phi.middleCols(1, kAll); }

TEST(UpdateCandidates, OfTheSameLaplacianHaveItsEigenvaluesAndNoResidual) {
    const Operator A(testing::withNoise(testing::icosphere(3), 0.03, 5));
    const HarmonicBasis all = denseBasis(A.laplacian, A.constants);
    Eigen::MatrixXd candidates = harmonics(all);
    const CandidateSpectrum spectrum =
        examineCandidates(A.laplacian, A.constants, kWanted, candidates, {});
    ASSERT_EQ(spectrum.quotient.size(), kAll);
    EXPECT_LT(spectrum.change, 1e-8);
    EXPECT_EQ(candidates, harmonics(all));
    const Eigen::ArrayXd lambda = all.lambda.segment(1, kAll);
    const Eigen::ArrayXd error = (spectrum.quotient.array() / lambda - 1.0).abs();
    EXPECT_LT(error.tail(kAll - kWanted + 48).maxCoeff(), 1e-9);
    // Of the others a sample is looked at; between its quotients those of the rest are estimated.
    for (Index i = 0; i < kWanted - 48; i += 8) EXPECT_LT(error[i], 1e-9) << i;
    EXPECT_TRUE(std::is_sorted(spectrum.quotient.begin(), spectrum.quotient.end()));
}

TEST(UpdateCandidates, NextToTheCutAreBroughtIntoOrder) {
    const Operator A(testing::withNoise(testing::icosphere(3), 0.03, 5));
    const HarmonicBasis all = denseBasis(A.laplacian, A.constants);
    Eigen::MatrixXd candidates = harmonics(all);
    candidates.rightCols(40) = candidates.rightCols(40).rowwise().reverse().eval();
    examineCandidates(A.laplacian, A.constants, kWanted, candidates, {});
    EXPECT_EQ(candidates, harmonics(all));
}

TEST(UpdateCandidates, TellHowMuchTheLaplacianHasChanged) {
    const testing::Mesh mesh = testing::withNoise(testing::icosphere(3), 0.03, 5);
    const HarmonicBasis previous = denseBasis(Operator(mesh).laplacian, Operator(mesh).constants);
    const auto changeUnder = [&](double stretch) {
        testing::Mesh changed = mesh;
        changed.V.col(0) *= stretch;
        const Operator A(changed);
        Eigen::MatrixXd candidates = harmonics(previous);
        return examineCandidates(A.laplacian, A.constants, kWanted, candidates, {}).change;
    };
    EXPECT_GT(changeUnder(1.01), 1e-3);
    EXPECT_GT(changeUnder(1.04), 2.0 * changeUnder(1.01));
}

}  // namespace
}  // namespace spectral
