// The report, the progress and the errors of the fractional filter.

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <string>

#include "core/filter/fractional_filter.h"
#include "core/mesh/measures.h"
#include "core/mesh/mesh.h"
#include "core/support/errors.h"
#include "core/support/frequency.h"
#include "core/support/progress.h"
#include "core/support/types.h"
#include "core/transfer/transfer_function.h"
#include "support/shapes.h"

namespace spectral {
namespace {

using testing::largestDifference;
using testing::Mesh;

FilterOptions smoothing(const Mesh& mesh, int steps, BasisUpdate update) {
    FilterOptions options;
    options.featureSize = 0.25 * boundingBoxDiagonal(mesh.V);
    options.steps = steps;
    options.basisUpdate = update;
    options.evaluation.accuracy = 1e-9;
    return options;
}

TEST(FractionalFilter, ReportsTheAreaOfPartsThatShrinkToALine) {
    // The tube of a thin ring has no harmonic below the cutoff, a ball has.
    Mesh ring = testing::torus(2, 0.1, 120, 12);
    ring.V.rowwise() += Eigen::RowVector3d(8, 0, 0);
    const Mesh ball = testing::icosphere(3), both = testing::joined(ball, ring);
    FilterOptions options;
    options.featureSize = 1.2;
    options.tolerance = 1e-3;
    const FilterResult result = fractionalFilter(both.V, both.F, options);
    const double part = surfaceArea(ring.V, ring.F) / surfaceArea(both.V, both.F);
    EXPECT_NEAR(result.shrunkenPart, part, 0.01 * part);
    EXPECT_EQ(fractionalFilter(ball.V, ball.F, options).shrunkenPart, 0.0);
    EXPECT_NEAR(result.meanEdge, meanEdgeLength(both.V, both.F), 1e-12);
    EXPECT_TRUE(result.hasVolume);
}

TEST(FractionalFilter, ReportsWhatItDid) {
    const Mesh mesh = testing::blob();
    FilterOptions options = smoothing(mesh, 4, BasisUpdate::Full);
    const FilterResult byProducts = fractionalFilter(mesh.V, mesh.F, options);
    EXPECT_EQ(byProducts.factorizations, 0);
    EXPECT_GT(byProducts.products, 0);
    options.evaluation.solver = Solver::Factorization;
    const FilterResult result = fractionalFilter(mesh.V, mesh.F, options);
    EXPECT_LT(largestDifference(result.V, byProducts.V), 1e-8);
    EXPECT_EQ(result.steps, 4);
    EXPECT_EQ(result.factorizations, 4);
    EXPECT_EQ(result.components, 1);
    EXPECT_EQ(result.unreferencedVertices, 0);
    EXPECT_NEAR(std::accumulate(result.stepSizes.begin(), result.stepSizes.end(), 0.0), 1.0, 1e-15);
    EXPECT_NEAR(result.cutoffFrequency * result.featureSize, 2.0 * kPi, 1e-12);
    EXPECT_GT(result.errorEstimate, 0.0);
    EXPECT_LE(result.errorEstimate, options.evaluation.accuracy);
    EXPECT_DOUBLE_EQ(result.areaAfter, surfaceArea(result.V, mesh.F));
    EXPECT_NEAR(result.maxDisplacement, largestDifference(result.V, mesh.V), 1e-14);
    EXPECT_EQ(result.eigenvalues.size(), 0);
}

TEST(FractionalFilter, StopsAtTheMaximumNumberOfStepsAndReportsTheError) {
    const Mesh mesh = testing::blob();
    FilterOptions options = smoothing(mesh, 0, BasisUpdate::Conformal);
    options.tolerance = 1e-6 * boundingBoxDiagonal(mesh.V);
    const FilterResult accurate = fractionalFilter(mesh.V, mesh.F, options);
    options.maxSteps = 2;
    const FilterResult quick = fractionalFilter(mesh.V, mesh.F, options);
    EXPECT_TRUE(accurate.toleranceReached);
    EXPECT_GT(accurate.steps, 2);
    EXPECT_EQ(quick.steps, 2);
    EXPECT_FALSE(quick.toleranceReached);
    const double error = largestDifference(quick.V, accurate.V);
    EXPECT_GT(error, options.tolerance);
    EXPECT_LT(error, 2.0 * quick.stepError);
    EXPECT_LT(error, 0.1 * quick.maxDisplacement);
}

TEST(FractionalFilter, EvaluatesToASmallShareOfTheEdgesWhateverTheTolerance) {
    const Mesh mesh = testing::withNoise(testing::icosphere(5), 1e-3, 1);
    const double size = std::sqrt(mesh.V.rowwise().squaredNorm().mean());
    for (const double tolerance : {1e-3, 0.1}) {
        FilterOptions options;
        options.featureSize = 0.2;
        options.tolerance = tolerance;
        const FilterResult result = fractionalFilter(mesh.V, mesh.F, options);
        EXPECT_LE(result.accuracy * size, 4e-3 * result.meanEdge) << tolerance;
        EXPECT_TRUE(result.accuracyReached);
    }
}

TEST(FractionalFilter, TellsAutomaticStepsFromThoseOfThePaper) {
    const Mesh mesh = testing::blob();
    EXPECT_EQ(fractionalFilter(mesh.V, mesh.F, smoothing(mesh, 2, BasisUpdate::Full)).passes, 0);
    FilterOptions options = smoothing(mesh, 0, BasisUpdate::Full);
    options.passes = 2;
    options.tolerance = 1e-12;
    const FilterResult result = fractionalFilter(mesh.V, mesh.F, options);
    EXPECT_EQ(result.passes, 2);
    EXPECT_EQ(result.steps, 2);
    EXPECT_TRUE(result.toleranceReached);  // nobody asked for it
}

TEST(FractionalFilter, ReportsThatTheAccuracyIsNotReached) {
    // The tenth root of a gain that vanishes inside the spectrum has a cusp there; a band-stop has
    // 1 % left.
    const Mesh mesh = testing::withNoise(testing::icosphere(4), 0.02, 5);
    FilterOptions options = smoothing(mesh, 10, BasisUpdate::Conformal);
    options.featureSize = 0.5;  // where the noise is
    const double cutoff = cutoffFrequency(options.featureSize);
    options.transferFunction.type = FilterType::Custom;
    options.transferFunction.custom = [=](double omega) { return std::abs(omega / cutoff - 1.0); };
    const FilterResult cusp = fractionalFilter(mesh.V, mesh.F, options);
    EXPECT_FALSE(cusp.accuracyReached);
    EXPECT_GT(cusp.errorEstimate, options.evaluation.accuracy);

    options.transferFunction.type = FilterType::BandStop;
    const FilterResult smooth = fractionalFilter(mesh.V, mesh.F, options);
    EXPECT_TRUE(smooth.accuracyReached);
}

TEST(FractionalFilter, ReportsThatTheHarmonicsEndBelowTheCutoff) {
    const Mesh mesh = testing::blob();
    FilterOptions options = smoothing(mesh, 2, BasisUpdate::Full);
    options.evaluation.spectrum = Spectrum::Truncated;
    options.evaluation.truncation.basisSize = 50;
    const FilterResult enough = fractionalFilter(mesh.V, mesh.F, options);
    EXPECT_TRUE(enough.cutoffReached);

    options.evaluation.truncation.basisSize = 5;
    const FilterResult few = fractionalFilter(mesh.V, mesh.F, options);
    EXPECT_LT(std::sqrt(few.eigenvalues[few.eigenvalues.size() - 1]), few.cutoffFrequency);
    EXPECT_FALSE(few.cutoffReached);

    // An ideal response needs no harmonic beyond its cutoff.
    options.evaluation.spectrum = Spectrum::Full;
    options.transferFunction.response = Response::Ideal;
    const FilterResult ideal = fractionalFilter(mesh.V, mesh.F, options);
    EXPECT_GT(ideal.eigenvalues.size(), 0);
    EXPECT_TRUE(ideal.cutoffReached);
}

TEST(FractionalFilter, ReportsProgressUpToTheEnd) {
    const Mesh mesh = testing::blob();
    double last = 0.0;
    int calls = 0;
    const Progress progress([&](double fraction, const std::string& stage) {
        EXPECT_GE(fraction, last - 1e-12);
        EXPECT_LE(fraction, 1.0);
        EXPECT_NE(stage.find(" of 5: "), std::string::npos);
        last = fraction;
        ++calls;
        return true;
    });
    fractionalFilter(mesh.V, mesh.F, smoothing(mesh, 5, BasisUpdate::Full), progress);
    EXPECT_GT(calls, 10);
    EXPECT_GT(last, 0.8);
}

// The fuzzer spoils all others.
TEST(FractionalFilter, RefusesOptionsOutOfRange) {
    const Mesh mesh = testing::icosphere(2);
    const auto refuses = [&](auto change) {
        FilterOptions options = smoothing(mesh, 2, BasisUpdate::Full);
        change(options);
        EXPECT_THROW(fractionalFilter(mesh.V, mesh.F, options), InvalidOption);
    };
    refuses([](FilterOptions& o) { o.steps = 1001; });
    refuses([](FilterOptions& o) { o.evaluation.accuracy = 0.0; });
    refuses([](FilterOptions& o) {
        o.evaluation.spectrum = Spectrum::Truncated;
        o.evaluation.truncation.basisSize = 162;
    });
}

TEST(FractionalFilter, DoesNotRoundSmallNumbersInErrorsToZero) {
    const Mesh mesh = testing::icosphere(1);
    FilterOptions options = smoothing(mesh, 2, BasisUpdate::Full);
    options.transferFunction.passGain = -1e-9;
    try {
        fractionalFilter(mesh.V, mesh.F, options);
        FAIL() << "a negative gain is no gain";
    } catch (const InvalidOption& error) {
        EXPECT_EQ(std::string(error.what()).find("pass_gain = -1e-09: "), 0U) << error.what();
    }
}

TEST(FractionalFilter, RefusesAFeatureSizeThatShrinksTheShapeToNothing) {
    const Mesh mesh = testing::withNoise(testing::icosphere(3), 0.03, 5);
    FilterOptions options;
    options.tolerance = 1e-3;
    for (const BasisUpdate update : {BasisUpdate::Conformal, BasisUpdate::Full})
        for (const double size : {1e1, 1e3, 1e9}) {
            options.featureSize = size;
            options.basisUpdate = update;
            try {
                fractionalFilter(mesh.V, mesh.F, options);
                ADD_FAILURE() << "feature size " << size;
            } catch (const SolverFailure& failure) {
                EXPECT_EQ(failure.code(), ErrorCode::ShrinksToNothing)
                    << failure.what() << ", feature size " << size;
            }
        }
}

}  // namespace
}  // namespace spectral
