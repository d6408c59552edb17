#include "core/filter/automatic_steps.h"

#include <gtest/gtest.h>

#include <map>
#include <numeric>
#include <string>
#include <vector>

#include "core/filter/fractional_steps.h"
#include "core/laplacian/interior.h"
#include "core/mesh/mesh.h"
#include "core/support/frequency.h"
#include "core/transfer/transfer_function.h"
#include "support/filter_of_blob.h"
#include "support/shapes.h"

namespace spectral {
namespace {

using testing::boost;
using testing::largestDifference;

/// Automatic steps, and the equal steps to compare them with.
struct Setting : testing::FilterOfBlob {
    using FilterOfBlob::FilterOfBlob;

    AutomaticSteps automatic(double tolerance, int maxSteps = 64, int passes = 0) const {
        StepEvaluator evaluate(evaluation, interior, F);
        return automaticSteps(laplacians, evaluate, surface.X, {tolerance, maxSteps, passes}, {});
    }

    Vertices midpoint(int K) const {
        StepEvaluator evaluate(evaluation, interior, F);
        return midpointSteps(laplacians, evaluate, surface.X, K, K, {}).X;
    }

    /// By Richardson's extrapolation of K and 2 K steps: the error is of a higher order.
    Vertices limit(int K) const {
        const Vertices Y = midpoint(2 * K);
        return Y + (Y - midpoint(K)) / 3.0;
    }
};

TEST(AutomaticSteps, KeepTheirToleranceAndEstimateTheirErrorWithinAFactorOfThree) {
    for (const BasisUpdate update : {BasisUpdate::Full, BasisUpdate::Conformal}) {
        for (const TransferFunctionOptions& options : {boost(), TransferFunctionOptions()}) {
            const Setting setting(options, 1.0, update);
            for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
                const AutomaticSteps steps = setting.automatic(tolerance);
                const int finer = 8 * static_cast<int>(steps.last.sizes.size());
                const double error = largestDifference(steps.last.X, setting.limit(finer));
                EXPECT_LE(steps.error, tolerance);
                EXPECT_LE(error, tolerance);
                EXPECT_LE(error, 3.0 * steps.error) << "tolerance " << tolerance;
                EXPECT_GE(error, steps.error / 3.0) << "tolerance " << tolerance;
                EXPECT_EQ(steps.singularPart, 0.0);
            }
        }
    }
}

TEST(AutomaticSteps, AreAsFewAsTheToleranceAllows) {
    const Setting setting(boost(), 1.0, BasisUpdate::Conformal);
    EXPECT_EQ(setting.automatic(1.0).last.sizes.size(), 1u);
    EXPECT_LT(setting.automatic(1e-3).last.sizes.size(), setting.automatic(1e-6).last.sizes.size());
}

TEST(AutomaticSteps, HavePowersThatSumToOne) {
    const Setting setting(boost(), 0.7, BasisUpdate::Full);
    for (const double tolerance : {1e-1, 1e-3}) {
        const std::vector<double> sizes = setting.automatic(tolerance).last.sizes;
        EXPECT_NEAR(std::accumulate(sizes.begin(), sizes.end(), 0.0), 1.0, 1e-12);
        for (const double size : sizes) EXPECT_GT(size, 0.0);
    }
}

TEST(AutomaticSteps, ReportWhenTheMaximumNumberStopsThem) {
    const Setting setting(boost(), 1.0, BasisUpdate::Full);
    const AutomaticSteps steps = setting.automatic(1e-8, 8);
    EXPECT_EQ(steps.last.sizes.size(), 8u);
    EXPECT_GT(steps.error, 1e-8);
    EXPECT_GT(steps.singularPart, 0.0);
    // The best result so far.
    const Vertices limit = setting.midpoint(64);
    EXPECT_LT(largestDifference(steps.last.X, limit),
              0.5 * largestDifference(setting.midpoint(8), limit));
}

TEST(AutomaticSteps, AreRepeatedExactlyByTheirNumberOfPasses) {
    for (const double tolerance : {1e-1, 1e-3, 1e-5}) {
        const Setting setting(boost(), 1.0, BasisUpdate::Conformal);
        const AutomaticSteps steps = setting.automatic(tolerance);
        const AutomaticSteps again = setting.automatic(1.0, 64, steps.passes);
        EXPECT_EQ(again.last.X, steps.last.X) << steps.passes;
        EXPECT_EQ(again.error, steps.error);
        EXPECT_EQ(again.passes, steps.passes);
    }
}

TEST(AutomaticSteps, AreNotHeldUpByPartsThatShrinkAway) {
    // Fragments of all sizes around the one that vanishes exactly at the end of the filter: for
    // some of them no number of steps suffices.
    testing::Mesh mesh = testing::blob();
    for (int i = 0; i < 40; ++i) {
        testing::Mesh fragment = testing::icosphere(1);
        fragment.V *= 0.02 + 0.002 * i;
        fragment.V.col(0).array() += 3.0 + 0.5 * i;
        mesh = testing::joined(mesh, fragment);
    }
    const Surface surface = surfaceOf(mesh.V, mesh.F);
    const Interior interior(surface.F, connectedComponents(surface.F, surface.X.rows()),
                            Boundary::Free);
    const TransferFunction F({}, cutoffFrequency(0.3));
    LaplacianBuilder laplacians(surface, interior.surfaceComponents(),
                                LaplacianKind::IntrinsicDelaunay, BasisUpdate::Conformal);
    EvaluationOptions evaluation;
    StepEvaluator evaluate(evaluation, interior, F);
    const double tolerance = 1e-3;
    const AutomaticSteps steps =
        automaticSteps(laplacians, evaluate, surface.X, {tolerance, 64}, {});
    EXPECT_LE(steps.last.sizes.size(), 8u);
    EXPECT_LE(steps.error, tolerance);
    EXPECT_GT(steps.singularPart, kNegligibleArea);
    EXPECT_LT(steps.singularPart, 0.1);
}

TEST(AutomaticSteps, ReportProgressThatNeverDecreases) {
    const Setting setting(boost(), 1.0, BasisUpdate::Full);
    double last = 0.0;
    int reports = 0;
    const Progress progress([&](double fraction, const std::string&) {
        EXPECT_GE(fraction, last - 1e-12);
        EXPECT_LE(fraction, 1.0 + 1e-12);
        last = fraction;
        ++reports;
        return true;
    });
    StepEvaluator evaluate(setting.evaluation, setting.interior, setting.F);
    automaticSteps(setting.laplacians, evaluate, setting.surface.X, {1e-4}, progress);
    EXPECT_GT(reports, 10);
}

TEST(AutomaticSteps, AreNotNearlyDoneWhenHalfOfTheirWorkIsLeft) {
    const Setting setting(boost(), 1.0, BasisUpdate::Full);
    for (const double tolerance : {1e-4, 1e-6, 1e-8}) {
        std::map<std::string, double> begins;  // of each pass, by the name of its first step
        const Progress progress([&](double fraction, const std::string& stage) {
            const std::size_t at = stage.find("step 1 of ");
            if (at == 0) begins.try_emplace(stage.substr(0, stage.find(':')), fraction);
            return true;
        });
        StepEvaluator evaluate(setting.evaluation, setting.interior, setting.F);
        const AutomaticSteps steps = automaticSteps(setting.laplacians, evaluate, setting.surface.X,
                                                    {tolerance, 32}, progress);
        const std::string last = "step 1 of " + std::to_string(steps.last.sizes.size());
        ASSERT_EQ(begins.count(last), 1u) << tolerance;
        EXPECT_LT(begins[last], 0.85) << tolerance;
    }
}

TEST(Progress, ThatOnlyGoesForwardsRepeatsTheFurthestFraction) {
    std::vector<double> seen;
    const Progress progress([&](double fraction, const std::string&) {
        seen.push_back(fraction);
        return true;
    });
    const Progress steady = progress.forwards();
    for (const double fraction : {0.1, 0.6, 0.2, 0.7}) steady.report(fraction, "");
    steady.part(0.5, 1.0).report(0.0, "");
    EXPECT_EQ(seen, (std::vector<double>{0.1, 0.6, 0.6, 0.7, 0.7}));
}

}  // namespace
}  // namespace spectral
