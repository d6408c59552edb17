#include "core/ldlt/kernels.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cstdlib>
#include <vector>

#include "core/ldlt/subnormals.h"
#include "core/support/types.h"
#include "support/evaluation.h"
#include "support/shapes.h"

namespace spectral {
namespace {

/// All instruction sets of this processor, by index; filters use the first.
class DenseKernels : public ::testing::TestWithParam<std::size_t> {
  protected:
    const Kernels& set() const { return availableKernels()[GetParam()]; }
};

INSTANTIATE_TEST_SUITE_P(Widest, DenseKernels,
                         ::testing::Range(std::size_t{0}, availableKernels().size()));

/// A frontal matrix in the documented memory layout.
class FrontOf {
  public:
    FrontOf(const Eigen::MatrixXd& A, Index width)
        : offset_((kLane - width % kLane) % kLane),
          below_(A.rows() - width),
          padded_((below_ + kLane - 1) / kLane * kLane),
          panel_(Eigen::MatrixXd::Zero(offset_ + width + padded_, width)),
          update_(Eigen::MatrixXd::Zero(padded_, below_)),
          scratch_(panel_.rows(), width) {
        panel_.middleRows(offset_, A.rows()) = A.leftCols(width).triangularView<Eigen::Lower>();
        update_.topRows(below_) =
            A.bottomRightCorner(below_, below_).triangularView<Eigen::Lower>();
    }

    FrontalMatrix front() {
        return {panel_.cols(), below_,         panel_.data(),  panel_.rows(),
                offset_,       update_.data(), scratch_.data()};
    }

    /// The columns of L, with the pivots on the diagonal instead of ones.
    Eigen::MatrixXd columns() const {
        return panel_.middleRows(offset_, panel_.cols() + below_).triangularView<Eigen::Lower>();
    }
    Eigen::MatrixXd update() const {
        return update_.topRows(below_).selfadjointView<Eigen::Lower>();
    }

  private:
    Index offset_, below_, padded_;
    Eigen::MatrixXd panel_, update_, scratch_;
};

TEST_P(DenseKernels, EliminatesFrontalMatrices) {
    std::srand(9);
    for (const Index width : {1, 2, 3, 4, 5, 9, 18, 67})
        for (const Index below : {0, 1, 3, 4, 7, 31, 70}) {
            const Index n = width + below;
            // Indefinite but diagonally dominant: no pivot is small.
            Eigen::MatrixXd A = Eigen::MatrixXd::Random(n, n);
            A = (A + A.transpose()).eval();
            for (Index i = 0; i < n; ++i)
                A(i, i) = (i % 3 == 0 ? -3.0 : 3.0) * static_cast<double>(n + i);
            FrontOf front(A, width);
            ASSERT_TRUE(set().eliminateFront(front.front()));
            Eigen::MatrixXd L = front.columns();
            const Eigen::VectorXd pivots = L.diagonal();
            L.diagonal().setOnes();
            Eigen::MatrixXd product = L * pivots.asDiagonal() * L.transpose();
            product.bottomRightCorner(below, below) += front.update();
            EXPECT_LT((product - A).norm(), 1e-13 * A.norm()) << width << ' ' << below;
        }
}

TEST_P(DenseKernels, IsBitIdenticalAtEveryAddress) {
    // Blocks of many columns leave a remainder of a few columns, whose product is small.
    constexpr Index kWidth = 8, kBelow = 36, kStride = kWidth + kBelow;
    std::srand(4);
    Eigen::MatrixXd panel = Eigen::MatrixXd::Random(kStride, kWidth), scratch(kStride, kWidth);
    panel.diagonal().setConstant(40.0);
    alignas(64) static double memory[kBelow * kBelow + kLane];
    Eigen::MatrixXd expected;
    for (Index shift = 0; shift < kLane; ++shift) {
        Eigen::MatrixXd columns = panel;
        Eigen::Map<Eigen::MatrixXd> contribution(memory + shift, kBelow, kBelow);
        contribution.setConstant(0.1);
        ASSERT_TRUE(set().eliminateFront(
            {kWidth, kBelow, columns.data(), kStride, 0, contribution.data(), scratch.data()}));
        if (shift == 0) expected = contribution;
        EXPECT_EQ(contribution, expected) << shift;
    }
}

TEST_P(DenseKernels, TreatsSubnormalNumbersAsZeroAndRestoresTheMode) {
#ifndef SPECTRAL_SUBNORMALS_ARE_SLOW
    GTEST_SKIP() << "subnormal numbers are as fast as others here";
#endif
    for (const Index width : {2, 40}) {  // with loops, and with Eigen's product
        const Index n = 2 * width + 30;
        Eigen::MatrixXd A = Eigen::MatrixXd::Constant(n, n, 1e-160);
        A.diagonal().setOnes();
        FrontOf front(A, width);
        ASSERT_TRUE(set().eliminateFront(front.front()));
        EXPECT_EQ(front.update(), A.bottomRightCorner(n - width, n - width));
        A.array() = (A.array() == 1.0).select(A, 1e-310);
        FrontOf subnormal(A, width);
        ASSERT_TRUE(set().eliminateFront(subnormal.front()));
        EXPECT_EQ(subnormal.columns().col(0).tail(n - 1).cwiseAbs().maxCoeff(), 0.0);
    }
    volatile double tiny = 1e-308;
    EXPECT_GT(tiny / 8.0, 0.0);
}

TEST_P(DenseKernels, ReportsAZeroPivot) {
    Eigen::MatrixXd A = Eigen::MatrixXd::Ones(7, 7);
    A.diagonal() << 1.0, 1.0, 3.0, 4.0, 5.0, 6.0, 7.0;
    FrontOf one(A, 1), five(A, 5);
    EXPECT_TRUE(set().eliminateFront(one.front()));
    EXPECT_FALSE(set().eliminateFront(five.front()));
}

/// LdltFactor::joined, derived from the rows.
std::vector<char> joinedColumns(const SparseMatrix& L) {
    std::vector<char> joined(static_cast<std::size_t>(L.cols()), 0);
    const int *row = L.innerIndexPtr(), *start = L.outerIndexPtr();
    for (int j = 0; j + 1 < L.cols(); ++j) {
        const bool isNext = start[j] < start[j + 1] && row[start[j]] == j + 1;
        joined[static_cast<std::size_t>(j)] =
            isNext && std::equal(row + start[j] + 1, row + start[j + 1], row + start[j + 1],
                                 row + start[j + 2]);
    }
    return joined;
}

class SparseKernels : public DenseKernels {
  protected:
    const testing::Operator A_{testing::withNoise(testing::icosphere(3), 0.03, 5)};
    const Index n_ = A_.W.rows();
};

INSTANTIATE_TEST_SUITE_P(Widest, SparseKernels,
                         ::testing::Range(std::size_t{0}, availableKernels().size()));

TEST_P(SparseKernels, SolvesWithAFactorization) {
    std::srand(6);
    SparseMatrix shifted = A_.W;
    shifted.diagonal() -= 7.0 * A_.D;
    const Eigen::SimplicialLDLT<SparseMatrix> ldlt(shifted);
    const SparseMatrix L = ldlt.matrixL().nestedExpression();
    const Eigen::VectorXd pivots = ldlt.vectorD();
    const std::vector<char> joined = joinedColumns(L);
    const LdltFactor factor{L.outerIndexPtr(), L.outerIndexPtr(), L.innerIndexPtr(), L.valuePtr(),
                            joined.data()};
    for (const int columns : {1, 2, 3, kMaxRightHandSides}) {
        const Eigen::MatrixXd B = Eigen::MatrixXd::Random(n_, columns);
        Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> Y =
            ldlt.permutationP() * B;
        set().forward(factor, Y.data(), columns, 0, n_);
        Y = pivots.cwiseInverse().asDiagonal() * Y;
        set().backward(factor, Y.data(), columns, 0, n_);
        const Eigen::MatrixXd X = ldlt.permutationPinv() * Eigen::MatrixXd(Y);
        EXPECT_LT((shifted * X - B).norm(), 1e-9 * B.norm()) << columns << " columns";
    }
}

}  // namespace
}  // namespace spectral
