#include "core/fractional_steps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "core/errors.h"
#include "core/measures.h"
#include "support/shapes.h"

namespace spectral {
namespace {

/// What the steps of a filter of `blob` need.
struct Setting {
    Surface surface;
    Components components;
    TransferFunction F;
    EvaluationOptions evaluation;
    LaplacianBuilder laplacians;

    Setting(const TransferFunctionOptions& options, double feature, BasisUpdate update)
        : surface(surfaceOf(testing::blob().V, testing::blob().F)),
          components(connectedComponents(surface.F, surface.X.rows())),
          F(options, 2.0 * kPi / feature),
          laplacians(surface, LaplacianKind::IntrinsicDelaunay, update) {
        evaluation.accuracy = 1e-9;
    }

    FractionalSteps automatic(double tolerance, int maxSteps = 100) const {
        StepEvaluator evaluate(evaluation, components, F);
        return automaticSteps(laplacians, evaluate, surface.X, {tolerance, maxSteps}, {});
    }

    Vertices fixed(int K, BasisUpdate update) const {
        StepEvaluator evaluate(evaluation, components, F);
        return fixedSteps(laplacians, evaluate, surface.X, K, update, {}).X;
    }
};

TransferFunctionOptions boost() {
    TransferFunctionOptions options;
    options.type = FilterType::BandPass;
    options.stopGain = 1.0;
    options.passGain = 2.0;
    return options;
}

double largestDifference(const Vertices& A, const Vertices& B) {
    return (A - B).rowwise().norm().maxCoeff();
}

TEST(FixedSteps, ConvergeToTheFlowAtFirstOrder) {
    for (const BasisUpdate update : {BasisUpdate::Full, BasisUpdate::Conformal}) {
        const Setting setting(boost(), 1.0, update);
        const Vertices limit = setting.automatic(1e-5).X;
        const double four = largestDifference(setting.fixed(4, update), limit);
        const double eight = largestDifference(setting.fixed(8, update), limit);
        const double sixteen = largestDifference(setting.fixed(16, update), limit);
        EXPECT_NEAR(four / eight, 2.0, 0.25);
        EXPECT_NEAR(eight / sixteen, 2.0, 0.25);
    }
}

TEST(AutomaticSteps, KeepTheirToleranceAndTheirEstimateBoundsTheError) {
    for (const BasisUpdate update : {BasisUpdate::Full, BasisUpdate::Conformal}) {
        const Setting setting(boost(), 1.0, update);
        const Vertices limit = setting.automatic(1e-6, 1000).X;
        for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
            const FractionalSteps steps = setting.automatic(tolerance);
            const double error = largestDifference(steps.X, limit);
            EXPECT_LE(steps.stepError, tolerance);
            EXPECT_LE(error, steps.stepError) << "tolerance " << tolerance;
            EXPECT_EQ(steps.singularPart, 0.0);
        }
    }
}

TEST(AutomaticSteps, TakeTheSquareRootOfTheAccuracyInSteps) {
    const Setting setting(boost(), 1.0, BasisUpdate::Conformal);
    const double coarse = static_cast<double>(setting.automatic(1e-3).sizes.size());
    const double fine = static_cast<double>(setting.automatic(1e-5).sizes.size());
    EXPECT_NEAR(fine / coarse, 10.0, 4.0);
}

TEST(AutomaticSteps, HavePowersThatSumToOne) {
    const Setting setting(boost(), 0.7, BasisUpdate::Full);
    for (const double tolerance : {1e-1, 1e-3}) {
        const std::vector<double> sizes = setting.automatic(tolerance).sizes;
        EXPECT_NEAR(std::accumulate(sizes.begin(), sizes.end(), 0.0), 1.0, 1e-12);
        for (const double size : sizes) EXPECT_GT(size, 0.0);
    }
}

TEST(AutomaticSteps, TellWhenNoStepIsSmallEnough) {
    const Setting setting(boost(), 1.0, BasisUpdate::Full);
    const FractionalSteps steps = setting.automatic(1e-7, 10);
    EXPECT_EQ(steps.sizes.size(), 10u);
    EXPECT_NEAR(steps.singularPart, 1.0, 1e-12);
    EXPECT_GT(steps.stepError, 1e-7);
    EXPECT_TRUE(steps.X.allFinite());
}

}  // namespace
}  // namespace spectral
