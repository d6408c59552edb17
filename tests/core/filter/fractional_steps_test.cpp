#include "core/filter/fractional_steps.h"

#include <gtest/gtest.h>

#include <numeric>

#include "core/mesh/mesh.h"
#include "core/transfer/transfer_function.h"
#include "support/filter_of_blob.h"
#include "support/shapes.h"

namespace spectral {
namespace {

using testing::boost;
using testing::largestDifference;

/// Steps of both kinds, and their common limit.
struct Setting : testing::FilterOfBlob {
    using FilterOfBlob::FilterOfBlob;

    Vertices paper(int K) const {
        StepEvaluator evaluate(evaluation, interior, F);
        return fixedSteps(laplacians, evaluate, surface.X, K, {}).X;
    }

    FractionalSteps midpoint(int K) const {
        StepEvaluator evaluate(evaluation, interior, F);
        return midpointSteps(laplacians, evaluate, surface.X, K, 64 * K, {});
    }

    /// The limit of infinitely many steps, far more accurate than any K below 64.
    Vertices limit() const {
        const Vertices Y = midpoint(64).X;
        return Y + (Y - midpoint(32).X) / 3.0;
    }
};

TEST(FixedSteps, ConvergeToTheFlowAtFirstOrder) {
    for (const BasisUpdate update : {BasisUpdate::Full, BasisUpdate::Conformal}) {
        const Setting setting(boost(), 1.0, update);
        const Vertices limit = setting.limit();
        const double four = largestDifference(setting.paper(4), limit);
        const double eight = largestDifference(setting.paper(8), limit);
        const double sixteen = largestDifference(setting.paper(16), limit);
        EXPECT_NEAR(four / eight, 2.0, 0.25);
        EXPECT_NEAR(eight / sixteen, 2.0, 0.25);
    }
}

TEST(MidpointSteps, ConvergeToTheSameFlowAtSecondOrder) {
    for (const BasisUpdate update : {BasisUpdate::Full, BasisUpdate::Conformal}) {
        const Setting setting(boost(), 1.0, update);
        const Vertices limit = setting.limit();
        const double four = largestDifference(setting.midpoint(4).X, limit);
        const double eight = largestDifference(setting.midpoint(8).X, limit);
        const double sixteen = largestDifference(setting.midpoint(16).X, limit);
        EXPECT_NEAR(four / eight, 4.0, 0.5);
        EXPECT_NEAR(eight / sixteen, 4.0, 0.5);
        EXPECT_LT(four, largestDifference(setting.paper(16), limit));
    }
}

TEST(MidpointSteps, HalveAStepThatFails) {
    // So steep a filter cannot be evaluated in one step over the whole spectrum, its powers can.
    TransferFunctionOptions steep;
    steep.response = Response::Butterworth;
    steep.order = 64;
    steep.passGain = 1e12;
    Setting setting(steep, 0.7, BasisUpdate::Conformal);
    setting.evaluation.accuracy = 1e-6;
    const FractionalSteps steps = setting.midpoint(1);
    EXPECT_GT(steps.sizes.size(), 1u);
    EXPECT_NEAR(std::accumulate(steps.sizes.begin(), steps.sizes.end(), 0.0), 1.0, 1e-12);
    EXPECT_TRUE(steps.X.allFinite());
}

}  // namespace
}  // namespace spectral
