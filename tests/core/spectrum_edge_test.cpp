#include "core/spectrum_edge.h"

#include <gtest/gtest.h>

#include <vector>

#include "core/errors.h"
#include "core/harmonic_basis.h"
#include "support/evaluation.h"
#include "support/shapes.h"

namespace spectral {
namespace {

using testing::Mesh;
using testing::Operator;

constexpr Index kHarmonics = 100;

/// The edge of a basis of kHarmonics, against the dense solver's.
class SpectrumEdgeOf {
  public:
    explicit SpectrumEdgeOf(const Mesh& mesh)
        : A(mesh),
          all(denseBasis(A.laplacian, A.constants)),
          workers(A.laplacian, A.constants, factors),
          edge(A.laplacian, A.constants, kHarmonics,
               all.lambda.segment(A.constants.count(), kHarmonics + 3), workers) {
        edge.run(0, [] {});
        edge.countAtEnd(0);
        edge.complete({});
    }

    Index below(double bound) const { return (all.lambda.array() < bound).count(); }

    Operator A;
    HarmonicBasis all;
    std::vector<ShiftedLdlt> factors;
    SliceWorkers workers;
    SpectrumEdge edge;
};

TEST(SpectrumEdge, HasAllPairsOnBothSidesOfTheCut) {
    SpectrumEdgeOf of(testing::withNoise(testing::icosphere(3), 0.03, 5));
    EXPECT_EQ(of.edge.eigenvaluesBelowShift(), of.below(of.edge.shift()));
    const Index before = of.edge.eigenvaluesBefore(), count = of.edge.pairs().size();
    EXPECT_LT(before, kHarmonics - 5);
    EXPECT_GT(before + count, kHarmonics + 5);
    EXPECT_EQ(before + count, of.below(of.edge.end()));
    const Eigen::VectorXd expected = of.all.lambda.segment(before, count);
    EXPECT_LT(((of.edge.pairs().lambdas() - expected).array() / expected.array()).abs().maxCoeff(),
              1e-8);
}

TEST(SpectrumEdge, HasAllCopiesOfMultipleEigenvaluesAboveItsShift) {
    SpectrumEdgeOf of(testing::icosphere(3));
    const Eigen::VectorXd lambda = of.edge.pairs().lambdas();
    const Index above = (lambda.array() >= of.edge.shift()).count();
    const Index first = of.below(of.edge.shift());
    ASSERT_EQ(first + above, of.below(of.edge.end()));
    const Eigen::VectorXd expected = of.all.lambda.segment(first, above);
    EXPECT_LT(((lambda.tail(above) - expected).array() / expected.array()).abs().maxCoeff(), 1e-8);
}

TEST(SpectrumEdge, CountsWhatItCosts) {
    SpectrumEdgeOf of(testing::withNoise(testing::icosphere(3), 0.03, 5));
    EXPECT_EQ(of.edge.factorizations(), 2);
    EXPECT_GT(of.edge.solves(), of.edge.pairs().size());
}

TEST(SpectrumEdge, CanBeStopped) {
    SpectrumEdgeOf of(testing::withNoise(testing::icosphere(3), 0.03, 5));
    SpectrumEdge again(of.A.laplacian, of.A.constants, kHarmonics,
                       of.all.lambda.segment(1, kHarmonics + 3), of.workers);
    EXPECT_THROW(again.run(0, [] { throw Cancelled(); }), Cancelled);
}

}  // namespace
}  // namespace spectral
