#include "core/rayleigh_ritz.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <cstdlib>
#include <numeric>

#include "core/errors.h"
#include "core/harmonic_basis.h"
#include "core/shifted_ldlt.h"
#include "support/evaluation.h"
#include "support/shapes.h"
#include "support/thread_shortage.h"

namespace spectral {
namespace {

using testing::Operator;

/// S becomes Ritz vectors, `wanted` of them.
Eigen::VectorXd apply(const Operator& A, Eigen::MatrixXd& S, Index wanted) {
    ShiftedLdlt factor;
    return rayleighRitz(
        A.laplacian, S, factor.order(A.laplacian), [&] { return wanted; }, Progress());
}

TEST(RayleighRitz, FindsThePairsThatASpaceHolds) {
    std::srand(5);
    const Operator A(testing::blob());
    const HarmonicBasis all = denseBasis(A.laplacian, A.constants);
    const Index first = 5, count = 40, wanted = 33;
    const Eigen::VectorXd lambda = all.lambda.segment(first, count);
    const Eigen::MatrixXd Phi = all.Phi.middleCols(first, count);
    Eigen::MatrixXd S = Phi * Eigen::MatrixXd::Random(count, count);

    const Eigen::VectorXd values = apply(A, S, wanted);

    ASSERT_EQ(values.size(), wanted);
    EXPECT_LT((values - lambda.head(wanted)).norm(), 1e-9 * lambda.norm());
    const Eigen::MatrixXd overlap = Phi.transpose() * A.laplacian.D.asDiagonal() * S;
    for (Index j = 0; j < wanted; ++j)
        EXPECT_NEAR(std::abs(overlap(j, j)), 1.0, 1e-9) << "harmonic " << j;
}

/// So many vertices that their rows are taken in several parts.
class RayleighRitzOfManyRows : public ::testing::Test {
  protected:
    RayleighRitzOfManyRows() {
        std::srand(6);
        S_ = Eigen::MatrixXd::Random(A_.laplacian.D.size(), 37);
    }

    const Operator A_{testing::withNoise(testing::icosphere(5), 0.005, 7)};
    Eigen::MatrixXd S_;
};

TEST_F(RayleighRitzOfManyRows, MakesVectorsOrthonormalInBothProducts) {
    Eigen::MatrixXd X = S_;
    const Eigen::VectorXd values = apply(A_, X, X.cols());
    const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(X.cols(), X.cols());
    const Eigen::MatrixXd H = X.transpose() * (A_.laplacian.W * X), theta = values.asDiagonal();
    EXPECT_LT((X.transpose() * A_.laplacian.D.asDiagonal() * X - I).norm(), 1e-12);
    EXPECT_LT((H - theta).norm(), 1e-12 * values.norm());
    EXPECT_TRUE(std::is_sorted(values.begin(), values.end()));
    // They span what was spanned.
    const Eigen::MatrixXd C = S_.householderQr().solve(X);
    EXPECT_LT((S_ * C - X).norm(), 1e-11 * X.norm());
}

TEST_F(RayleighRitzOfManyRows, DoesNotDependOnTheNumberOfCores) {
    Eigen::MatrixXd X = S_, alone = S_;
    const Eigen::VectorXd values = apply(A_, X, X.cols());
    const testing::ThreadShortage noThreads(0);
    EXPECT_EQ(apply(A_, alone, X.cols()), values);
    EXPECT_EQ(alone, X);
}

TEST_F(RayleighRitzOfManyRows, DoesNotDependOnTheOrderOfRowsButForRounding) {
    Eigen::MatrixXd X = S_, Y = S_;
    const Eigen::VectorXd values = apply(A_, X, X.cols());
    std::vector<int> order(static_cast<std::size_t>(S_.rows()));
    std::iota(order.rbegin(), order.rend(), 0);
    const Eigen::VectorXd others =
        rayleighRitz(A_.laplacian, Y, order, [&] { return X.cols(); }, Progress());
    EXPECT_LT((values - others).norm(), 1e-12 * values.norm());
    EXPECT_LT((X.cwiseAbs() - Y.cwiseAbs()).norm(), 1e-9 * X.norm());
}

TEST_F(RayleighRitzOfManyRows, RefusesDependentVectors) {
    S_.col(3) = S_.col(7) - S_.col(9);
    EXPECT_THROW(apply(A_, S_, 5), SolverFailure);
}

}  // namespace
}  // namespace spectral
