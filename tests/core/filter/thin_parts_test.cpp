#include "core/filter/thin_parts.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/filter/fractional_filter.h"
#include "core/laplacian/laplacian_builder.h"
#include "core/mesh/measures.h"
#include "support/evaluation.h"
#include "support/shapes.h"

namespace spectral {
namespace {

using testing::largestDifference;
using testing::Mesh;

constexpr double kSize = 1.2;

/// A ring whose tube, of girth 0.63, a low-pass of kSize shrinks to a line.
Mesh thinRing() {
    Mesh ring = testing::torus(2, 0.1, 120, 12);
    ring.V.rowwise() += Eigen::RowVector3d(8, 0, 0);
    return ring;
}

FilterResult lowPass(const Mesh& mesh, bool keepThinParts) {
    FilterOptions options;
    options.featureSize = kSize;
    options.tolerance = 1e-3;
    options.keepThinParts = keepThinParts;
    return fractionalFilter(mesh.V, mesh.F, options);
}

/// F(sqrt(A)) X of a Gaussian low-pass of a feature size, one shot.
Vertices oneShot(const Mesh& mesh, double featureSize) {
    FilterOptions options;
    options.featureSize = featureSize;
    options.steps = 1;
    return fractionalFilter(mesh.V, mesh.F, options).V;
}

/// For a Gaussian, F^(1/4) is the low-pass of half the size.
Eigen::VectorXd factors(const Mesh& mesh) {
    const MeshLaplacian of = meshLaplacian(mesh.V, mesh.F, LaplacianKind::IntrinsicDelaunay);
    return thinPartFactors(of.laplacian.W, mesh.F, mesh.V, oneShot(mesh, 0.5 * kSize),
                           oneShot(mesh, kSize))
        .factors;
}

TEST(ThinParts, KeepHalfOfTheirAreaInsteadOfShrinkingToALine) {
    const Mesh ring = thinRing(), ball = testing::icosphere(3), both = testing::joined(ball, ring);
    const FilterResult drawnIn = lowPass(both, false), kept = lowPass(both, true);
    const Index n = ball.V.rows();
    const double area = surfaceArea(ring.V, ring.F);
    EXPECT_GT(drawnIn.shrunkenPart, 0.1);
    EXPECT_LT(surfaceArea(drawnIn.V.bottomRows(ring.V.rows()), ring.F), 0.1 * area);
    EXPECT_EQ(kept.shrunkenPart, 0.0);
    EXPECT_GT(surfaceArea(kept.V.bottomRows(ring.V.rows()), ring.F), 0.5 * area);
    EXPECT_LT(kept.maxDisplacement, 0.1);
    // The rest is filtered as before, within the tolerance.
    EXPECT_LT(largestDifference(kept.V.topRows(n), drawnIn.V.topRows(n)), 2e-3);
}

TEST(ThinParts, HaveTheFactorThatKeepsThreeQuarters) {
    // The girth of a tube is known: a Gaussian takes it to F(2 pi / girth) at once.
    const Mesh ring = thinRing();
    const double exponent = 0.5 * std::log(2.0) * std::pow(kSize / (2.0 * kPi * 0.1), 2);
    const Eigen::VectorXd found = factors(ring);
    ASSERT_EQ(found.size(), ring.V.rows());
    EXPECT_NEAR(found.mean(), exponent / -std::log(0.75), 0.1 * found.mean());
    // The outside of the ring is 10 % longer than the inside.
    EXPECT_LT(found.maxCoeff() - found.minCoeff(), 0.1 * found.mean());
}

TEST(ThinParts, AreNoneWhereTheShapeIsThickOrNoisy) {
    const Mesh ball = testing::icosphere(4);
    EXPECT_EQ(factors(ball).size(), 0);
    const double edge = meanEdgeLength(ball.V, ball.F);
    EXPECT_EQ(factors(testing::withNoise(ball, 0.3 * edge, 1)).size(), 0);
    EXPECT_EQ(lowPass(ball, true).V, lowPass(ball, false).V);
}

TEST(ThinParts, StayWhereTheyAreWhenNothingOfThemWouldBeLeft) {
    Mesh speck = testing::icosphere(1);
    speck.V = (0.01 * speck.V).rowwise() + Eigen::RowVector3d(3, 0, 0);
    const Mesh ball = testing::icosphere(3), both = testing::joined(ball, speck);
    const FilterResult kept = lowPass(both, true);
    const Index n = speck.V.rows();
    EXPECT_LT(largestDifference(kept.V.bottomRows(n), both.V.bottomRows(n)), 1e-5);
}

TEST(ThinParts, AreKeptByEveryScheme) {
    const Mesh ring = thinRing();
    for (const BasisUpdate update :
         {BasisUpdate::Full, BasisUpdate::Conformal, BasisUpdate::None}) {
        FilterOptions options;
        options.featureSize = kSize;
        options.steps = 4;
        options.basisUpdate = update;
        options.keepThinParts = true;
        EXPECT_EQ(fractionalFilter(ring.V, ring.F, options).shrunkenPart, 0.0);
    }
}

TEST(ThinParts, OfAnotherTileDecideForATile) {
    // A tube that loses a third of its area, next to one that would lose all.
    const Mesh tube = testing::torus(2, 0.17, 120, 20), both = testing::joined(tube, thinRing());
    FilterOptions options;
    options.featureSize = kSize;
    options.tolerance = 1e-3;
    options.keepThinParts = true;
    const FilterResult whole = fractionalFilter(both.V, both.F, options);
    options.passes = whole.passes;
    const std::vector<bool> inner(static_cast<std::size_t>(tube.V.rows()), true);
    options.whole = {whole.meanEdge, false, inner};
    const FilterResult alone = fractionalFilter(tube.V, tube.F, options);
    EXPECT_GT(alone.thinPartFactor, 1.0);
    EXPECT_LT(alone.thinPartFactor, 2.0);
    EXPECT_GT(whole.thinPartFactor, 2.0);
    options.whole->hasThinParts = true;
    const FilterResult tile = fractionalFilter(tube.V, tube.F, options);
    const Vertices expected = whole.V.topRows(tube.V.rows());
    EXPECT_GT(largestDifference(alone.V, expected), 1e-2);
    EXPECT_LT(largestDifference(tile.V, expected), 1e-4);
    // What is thin only because it was cut out does not count.
    options.whole = {whole.meanEdge, false, std::vector<bool>(inner.size(), false)};
    EXPECT_EQ(fractionalFilter(tube.V, tube.F, options).thinPartFactor, 1.0);
}

TEST(ThinParts, AreDrawnInByFiltersThatAreNoLowPass) {
    const Mesh ring = thinRing();
    FilterOptions options;
    options.featureSize = kSize;
    options.tolerance = 1e-3;
    options.transferFunction.type = FilterType::BandStop;
    options.transferFunction.stopGain = 0.5;
    const Vertices without = fractionalFilter(ring.V, ring.F, options).V;
    options.keepThinParts = true;
    EXPECT_EQ(fractionalFilter(ring.V, ring.F, options).V, without);
}

}  // namespace
}  // namespace spectral
