#include "core/slice_layout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace spectral {
namespace {

std::vector<SliceOfVectors> ascending(std::vector<SliceOfVectors> slices) {
    std::sort(slices.begin(), slices.end(),
              [](const SliceOfVectors& a, const SliceOfVectors& b) { return a.first < b.first; });
    return slices;
}

TEST(SliceLayout, TakesEveryVectorOnceWithItsSliceOfTheSpectrum) {
    for (const Index count : {1, 4, 5, 121, 300}) {
        const Eigen::VectorXd quotient =
            Eigen::VectorXd::LinSpaced(count, 1.0, static_cast<double>(count));
        const double bound = static_cast<double>(count) + 9.0;
        Index next = 0;
        for (const SliceOfVectors& vectors : ascending(layOutSlices(quotient, bound, 7.0))) {
            EXPECT_EQ(vectors.first, next);
            ASSERT_GT(vectors.count, 0);
            next += vectors.count;
            EXPECT_EQ(vectors.slice.from, quotient[vectors.first]);
            EXPECT_EQ(vectors.slice.to, quotient[next - 1]);
            EXPECT_EQ(vectors.slice.bound, bound);
            EXPECT_EQ(vectors.slice.damping, 7.0);
        }
        EXPECT_EQ(next, count);
    }
}

TEST(SliceLayout, MakesSlicesNarrowerNearTheBound) {
    const Eigen::VectorXd quotient = Eigen::VectorXd::LinSpaced(300, 1.0, 300.0);
    const std::vector<SliceOfVectors> slices = ascending(layOutSlices(quotient, 310.0, 10.0));
    ASSERT_GT(slices.size(), 2u);
    EXPECT_LT(slices.back().count, slices.front().count);
}

TEST(SliceLayout, NeedsNoSecondSliceForEqualEigenvalues) {
    EXPECT_EQ(layOutSlices(Eigen::VectorXd::Constant(200, 3.0), 4.0, 100.0).size(), 1u);
}

TEST(SliceLayout, PutsTheMostExpensiveFirst) {
    const Eigen::VectorXd quotient = Eigen::VectorXd::LinSpaced(300, 1.0, 300.0);
    const std::vector<SliceOfVectors> slices = layOutSlices(quotient, 310.0, 10.0);
    const auto solves = [](const SliceOfVectors& vectors) {
        return static_cast<Index>(iterations(vectors.slice)) * vectors.count;
    };
    EXPECT_GE(solves(slices.front()), solves(slices.back()));
}

}  // namespace
}  // namespace spectral
