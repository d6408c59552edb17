#include "core/krylov/full_spectrum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "core/laplacian/constant_modes.h"
#include "core/mesh/measures.h"
#include "core/mesh/mesh.h"
#include "core/support/frequency.h"
#include "core/transfer/transfer_function.h"
#include "support/evaluation.h"

namespace spectral {
namespace {

using testing::Mesh;
using testing::Operator;

constexpr double kRoundOff = 1e-13;

std::vector<Mesh> classesOfMeshes() {
    return {testing::blob(), testing::withNoise(testing::rectangle(2, 1, 24, 12), 0.03, 3),
            testing::joined(testing::withNoise(testing::icosphere(2), 0.05, 5),
                            testing::torus(2, 0.7, 16, 8)),
            testing::withNoise(testing::cube(8), 0.02, 4)};
}

TEST(FullSpectrum, EqualsAllEigenvectorsWithinTheRequestedAccuracy) {
    for (const Mesh& mesh : classesOfMeshes()) {
        const Operator A(mesh);
        const HarmonicBasis dense = denseBasis(A);
        for (const auto& [feature, alpha] : {std::pair{0.3, 1.0}, {0.3, 0.1}, {1.0, 0.1}})
            for (const auto& options : testing::smoothTransferFunctions()) {
                const TransferFunction F(options, 2.0 * kPi / feature);
                const Gain gain = fractionalPower(F, alpha);
                const double accuracy = 1e-6;
                const FullSpectrumResult result =
                    testing::filteredFullSpectrum(A, gain, F.cutoff(), accuracy);
                const Vertices expected = testing::filteredDense(A, dense, gain);
                EXPECT_TRUE(result.converged);
                EXPECT_EQ(result.converged, result.errorEstimate <= accuracy);
                EXPECT_LE(testing::relativeError(A, result.Y - expected),
                          result.errorEstimate + kRoundOff)
                    << testing::describe(options) << ", feature " << feature << ", alpha " << alpha
                    << ", dimension " << result.dimension;
            }
    }
}

TEST(FullSpectrum, ReachesTightAccuracies) {
    const Operator A(testing::blob());
    const HarmonicBasis dense = denseBasis(A);
    const TransferFunction F({}, 2.0 * kPi / 0.8);
    const Gain gain = fractionalPower(F, 1.0);
    const Vertices expected = testing::filteredDense(A, dense, gain);
    int dimension = 0;
    for (const double accuracy : {1e-3, 1e-5, 1e-7, 1e-9, 1e-11}) {
        const FullSpectrumResult result =
            testing::filteredFullSpectrum(A, gain, F.cutoff(), accuracy);
        EXPECT_LE(testing::relativeError(A, result.Y - expected), accuracy);
        EXPECT_GE(result.dimension, dimension);
        dimension = result.dimension;
    }
}

TEST(FullSpectrum, DoesNotStopBeforeItSeesANarrowBand) {
    const Operator A(testing::blob());
    const HarmonicBasis dense = denseBasis(A);
    TransferFunctionOptions options;
    options.type = FilterType::BandPass;
    options.stopGain = 1.0;
    options.passGain = 3.0;
    for (const double width : {0.5, 0.25, 0.1})
        for (const double feature : {0.3, 0.6, 1.5}) {
            options.bandWidth = width;
            const TransferFunction F(options, 2.0 * kPi / feature);
            const Gain gain = fractionalPower(F, 1.0);
            const FullSpectrumResult result =
                testing::filteredFullSpectrum(A, gain, F.cutoff(), 1e-6);
            EXPECT_LE(testing::relativeError(A, result.Y - testing::filteredDense(A, dense, gain)),
                      1e-6)
                << "width " << width << ", feature " << feature;
        }
}

TEST(FullSpectrum, ClaimsNoAccuracyForABandThatItsSpacesMiss) {
    // A band so narrow that it lies between Ritz values, with gain 1 at all of them:
    // approximations that miss the band agree.
    const Operator A(testing::joined(testing::withNoise(testing::icosphere(2), 0.05, 5),
                                     testing::torus(2, 0.7, 16, 8)));
    const HarmonicBasis dense = denseBasis(A);
    TransferFunctionOptions options;
    options.type = FilterType::BandPass;
    options.stopGain = 1.0;
    options.passGain = 3.0;
    int claims = 0, all = 0;
    for (const double width : {0.001, 0.005, 0.02, 0.1})
        for (double feature = 0.08; feature < 8.0; feature *= 1.3, ++all) {
            options.bandWidth = width;
            const TransferFunction F(options, 2.0 * kPi / feature);
            const Gain gain = fractionalPower(F, 1.0);
            const double accuracy = 1e-6;
            const FullSpectrumResult result =
                testing::filteredFullSpectrum(A, gain, F.cutoff(), accuracy, F.samples());
            if (!result.converged) continue;
            ++claims;
            EXPECT_LE(testing::relativeError(A, result.Y - testing::filteredDense(A, dense, gain)),
                      accuracy)
                << "width " << width << ", feature " << feature;
        }
    EXPECT_GT(claims, all / 2);
}

TEST(FullSpectrum, ReportsItsAccuracyForFeatureSizesFarOutsideTheSpectrum) {
    const Operator A(testing::blob());
    const HarmonicBasis dense = denseBasis(A);
    for (const double feature : {1e-7, 1e-3, 1e3, 1e7})
        for (const auto& options : testing::smoothTransferFunctions()) {
            const TransferFunction F(options, 2.0 * kPi / feature);
            const Gain gain = fractionalPower(F, 1.0);
            const FullSpectrumResult result =
                testing::filteredFullSpectrum(A, gain, F.cutoff(), 1e-6, F.samples());
            const Vertices expected = testing::filteredDense(A, dense, gain);
            EXPECT_TRUE(result.converged);
            EXPECT_LE(testing::relativeError(A, result.Y - expected),
                      result.errorEstimate + kRoundOff)
                << testing::describe(options) << ", feature " << feature;
        }
}

TEST(FullSpectrum, KeepsConstantModesWhateverTheGainAtZero) {
    const Operator A(testing::joined(testing::blob(), testing::torus(3, 1, 16, 8)));
    for (const double gainAtAll : {0.0, 3.0}) {
        const FullSpectrumResult result =
            testing::filteredFullSpectrum(A, [&](double) { return gainAtAll; }, 1.0, 1e-9);
        EXPECT_LT((A.constants.means(A.D, result.Y) - A.constants.means(A.D, A.mesh.V))
                      .cwiseAbs()
                      .maxCoeff(),
                  1e-13);
    }
}

TEST(FullSpectrum, IsExactWhenTheKrylovSpaceIsInvariant) {
    const Operator A(testing::icosphere(0));  // only three frequencies
    const FullSpectrumResult result =
        testing::filteredFullSpectrum(A, [](double omega) { return omega; }, 1.0, 1e-12);
    const HarmonicBasis dense = denseBasis(A);
    const Vertices expected = testing::filteredDense(A, dense, [](double omega) { return omega; });
    EXPECT_LT((result.Y - expected).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(FullSpectrum, IsAccurateAtVerticesOfTinyMass) {
    Mesh tiny = testing::icosphere(0);  // the larger one alone has an invariant space
    tiny.V *= 1e-6;
    const Operator A(testing::joined(testing::icosphere(0), tiny));
    const HarmonicBasis dense = denseBasis(A);
    const double cutoff = 1.5e6;
    const Gain gain = fractionalPower(TransferFunction({}, cutoff), 1.0);
    const FullSpectrumResult result = testing::filteredFullSpectrum(A, gain, cutoff, 1e-8);
    const Vertices expected = testing::filteredDense(A, dense, gain);
    EXPECT_GT((expected - A.mesh.V).cwiseAbs().maxCoeff(), 1e-7);
    EXPECT_LT((result.Y - expected).cwiseAbs().maxCoeff(), 1e-8);
}

TEST(FullSpectrum, DoesNotMistakeAVertexOfTinyMassForRoundOff) {
    // As in a step after a thin part has shrunk to nothing.
    Operator A(testing::blob());
    A.D[0] = 1e-12 * A.D.mean();
    A.constants = ConstantModes(connectedComponents(A.mesh.F, A.mesh.V.rows()), A.D);
    const HarmonicBasis dense = denseBasis(A);
    const double cutoff = cutoffFrequency(0.2 * boundingBoxDiagonal(A.mesh.V));
    const Gain gain = fractionalPower(TransferFunction({}, cutoff), 0.1);
    const FullSpectrumResult result = testing::filteredFullSpectrum(A, gain, cutoff, 1e-7);
    const Vertices error = result.Y - testing::filteredDense(A, dense, gain);
    EXPECT_TRUE(result.converged) << result.errorEstimate;
    EXPECT_LT(error.cwiseAbs().maxCoeff(), 1e-7 * A.mesh.V.cwiseAbs().maxCoeff());
}

TEST(FullSpectrum, SeesAPartOfTinyMassWhereAllElseVanishes) {
    Mesh tiny = testing::icosphere(0);
    tiny.V *= 1e-5;
    const Operator A(testing::joined(testing::cube(2), tiny));
    TransferFunctionOptions highPass;
    highPass.type = FilterType::HighPass;
    const double cutoff = 30.0;  // between the frequencies of the two
    const FullSpectrumResult result = testing::filteredFullSpectrum(
        A, fractionalPower(TransferFunction(highPass, cutoff), 1.0), cutoff, 1e-6);
    const Eigen::MatrixXd change = result.Y - A.mesh.V;
    EXPECT_TRUE(result.converged);
    EXPECT_LT(change.bottomRows(tiny.V.rows()).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(FullSpectrum, LeavesConstantSignalsAlone) {
    const Operator A(testing::blob());
    ShiftedLdlt ldlt;
    ldlt.factorizeDefinite(A.W, A.D, 1.0);
    const Eigen::MatrixXd X = Eigen::MatrixXd::Constant(A.mesh.V.rows(), 2, 4.0);
    const FullSpectrumResult result =
        applyFullSpectrum(A, ShiftInvert(ldlt), {[](double) { return 0.0; }}, X, {}).front();
    EXPECT_TRUE(result.converged);
    EXPECT_LT((result.Y - X).cwiseAbs().maxCoeff(), 1e-14);
}

TEST(FullSpectrum, ReportsATransferFunctionThatIsTooSteep) {
    const Operator A(testing::blob());
    const HarmonicBasis dense = denseBasis(A);
    ShiftedLdlt ldlt;
    ldlt.factorizeDefinite(A.W, A.D, 40.0);
    const Gain step = [](double omega) { return omega < 6.0 ? 1.0 : 0.0; };
    FullSpectrumOptions options;
    options.maxDimension = 24;
    const FullSpectrumResult result =
        applyFullSpectrum(A, ShiftInvert(ldlt), {step}, A.mesh.V, options).front();
    EXPECT_FALSE(result.converged);
    EXPECT_EQ(result.dimension, 24);
    EXPECT_LE(testing::relativeError(A, result.Y - testing::filteredDense(A, dense, step)),
              result.errorEstimate);
}

}  // namespace
}  // namespace spectral
