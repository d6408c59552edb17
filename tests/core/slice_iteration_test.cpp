#include "core/slice_iteration.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

#include "core/errors.h"
#include "core/harmonic_basis.h"
#include "core/mass_products.h"
#include "support/evaluation.h"
#include "support/shapes.h"

namespace spectral {
namespace {

using testing::Operator;

/// Harmonics of the slice, and the first that lies beyond its bound.
constexpr Index kFirst = 20, kCount = 20, kBeyond = 60;

constexpr double kDamping = 1000.0;

Slice sliceOf(const Eigen::VectorXd& lambda) {
    return {lambda[kFirst], lambda[kFirst + kCount - 1], lambda[kBeyond], kDamping};
}

Eigen::MatrixXd random(Index rows, Index columns, unsigned seed) {
    std::mt19937 generator(seed);
    std::normal_distribution<double> normal;
    return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(generator); });
}

TEST(SliceIteration, DampsWhatIsBeyondTheBound) {
    const Operator A(testing::withNoise(testing::icosphere(3), 0.03, 5));
    const HarmonicBasis all = denseBasis(A.laplacian, A.constants);
    const Slice slice = sliceOf(all.lambda);
    const Index beyond = all.size() - kBeyond;
    Eigen::MatrixXd S = all.Phi.middleCols(kFirst, kCount) +
                        1e-3 * all.Phi.rightCols(beyond) * random(beyond, kCount, 1);
    ShiftedLdlt factor;
    factor.factorize(A.laplacian, slice.middle());
    iterate(A.laplacian, A.constants, factor, slice, S, [] {});

    // Sines of the angles between the vectors' span and that of the slice.
    const Eigen::MatrixXd kept =
        innerProducts(all.Phi.middleCols(kFirst, kCount), A.laplacian.D, S);
    const Eigen::MatrixXd left = innerProducts(all.Phi.rightCols(beyond), A.laplacian.D, S);
    const Eigen::MatrixXd tangents = left * kept.inverse();
    const double before = 1e-3 * random(beyond, kCount, 1).norm();
    EXPECT_LT(tangents.norm(), before / kDamping);
}

TEST(SliceIteration, TakesMoreIterationsNearTheBoundAndForMoreDamping) {
    EXPECT_EQ(iterations({1.0, 2.0, 100.0, 100.0}), 1);
    EXPECT_GT(iterations({1.0, 2.0, 2.5, 100.0}), iterations({1.0, 2.0, 6.0, 100.0}));
    EXPECT_GT(iterations({1.0, 2.0, 6.0, 1000.0}), iterations({1.0, 2.0, 6.0, 10.0}));
    EXPECT_EQ(iterations({2.0, 2.0, 2.5, 100.0}), 1);  // one multiple eigenvalue
}

TEST(SliceIteration, SaysWhenVectorsAreDependent) {
    const Operator A(testing::withNoise(testing::icosphere(3), 0.03, 5));
    const Slice slice{5.0, 10.0, 30.0, kDamping};
    Eigen::MatrixXd S = random(A.laplacian.D.size(), 3, 2);
    S.col(2).setZero();
    ShiftedLdlt factor;
    factor.factorize(A.laplacian, slice.middle());
    EXPECT_THROW(iterate(A.laplacian, A.constants, factor, slice, S, [] {}), SolverFailure);
}

}  // namespace
}  // namespace spectral
