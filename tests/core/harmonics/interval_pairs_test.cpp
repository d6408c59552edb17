#include "core/harmonics/interval_pairs.h"

#include <gtest/gtest.h>

#include "core/harmonics/harmonic_basis.h"
#include "core/support/errors.h"
#include "support/evaluation.h"
#include "support/shapes.h"

namespace spectral {
namespace {

using testing::Operator;

const StopPoint kNeverStops = [] {};

/// Halfway from one eigenvalue to the next.
double between(const Eigen::VectorXd& lambda, Index below) {
    return 0.5 * (lambda[below - 1] + lambda[below]);
}

SpectralInterval intervalOf(const Eigen::VectorXd& lambda, Index first, Index count) {
    return {between(lambda, first), between(lambda, first + count), first, count};
}

/// Largest norm of the part of a vector of `Phi` that is outside `space`.
double outside(const Operator& A, const Eigen::MatrixXd& Phi, const Eigen::MatrixXd& space) {
    const Eigen::MatrixXd rest = Phi - space * (space.transpose() * (A.D.asDiagonal() * Phi));
    return (A.D.cwiseSqrt().asDiagonal() * rest).colwise().norm().maxCoeff();
}

TEST(ComputeInterval, AgreesWithTheDenseSolver) {
    const Operator A(testing::blob());
    const HarmonicBasis dense = denseBasis(A);
    ShiftedLdlt factor;
    for (const Index first : {1, 30, 200}) {
        const SpectralInterval interval = intervalOf(dense.lambda, first, 12);
        const IntervalPairs pairs = computeInterval(A, interval, factor, kNeverStops);
        ASSERT_TRUE(pairs.isComplete()) << first;
        EXPECT_LT((pairs.lambda - dense.lambda.segment(first, 12)).cwiseAbs().maxCoeff(),
                  1e-10 * dense.lambda[first + 12]);
        EXPECT_LT(outside(A, pairs.Phi, dense.Phi.middleCols(first, 12)), 1e-8) << first;
    }
}

TEST(ComputeInterval, IsIncompleteWhenItsCountIsWrong) {
    const Operator A(testing::blob());
    const Eigen::VectorXd lambda = denseBasis(A).lambda;
    ShiftedLdlt factor;
    for (const Index wrong : {-1, 1}) {
        SpectralInterval interval = intervalOf(lambda, 30, 12);
        interval.count += wrong;
        EXPECT_FALSE(computeInterval(A, interval, factor, kNeverStops).isComplete());
    }
}

TEST(Orthonormalize, DetectsARepeatedVector) {
    const Operator A(testing::blob());
    const HarmonicBasis dense = denseBasis(A);
    Eigen::MatrixXd U = dense.Phi.middleCols(5, 3) + 0.1 * dense.Phi.leftCols(3);
    EXPECT_GT(orthonormalize(A.D, dense.Phi.leftCols(5), U), kOwnPart);
    EXPECT_LT(outside(A, U, dense.Phi.middleCols(5, 3)), 1e-12);
    U.col(1) = dense.Phi.col(2) + 1e-3 * U.col(1);
    EXPECT_LT(orthonormalize(A.D, dense.Phi.leftCols(5), U), kOwnPart);
}

}  // namespace
}  // namespace spectral
