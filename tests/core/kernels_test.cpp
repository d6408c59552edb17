#include "core/kernels.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <vector>

#include "core/row_panels.h"
#include "core/types.h"
#include "support/evaluation.h"
#include "support/shapes.h"

namespace spectral {
namespace {

/// Those of the sets that this processor has, by their place: it takes the first, others another.
class KernelsOfEverySet : public ::testing::TestWithParam<std::size_t> {
  protected:
    const Kernels& kernels() const { return availableKernels()[GetParam()]; }
};

INSTANTIATE_TEST_SUITE_P(Widest, KernelsOfEverySet,
                         ::testing::Range(std::size_t{0}, availableKernels().size()));

TEST_P(KernelsOfEverySet, MultipliesDenseMatrices) {
    std::srand(3);
    for (const Index n : {1, 7, 512, 1030})
        for (const Index p : {1, 3, 8, 29})
            for (const Index q : {1, 2, 3, 4, 5, 17}) {
                const Eigen::MatrixXd A = Eigen::MatrixXd::Random(n, p);
                const Eigen::MatrixXd B = Eigen::MatrixXd::Random(n, q);
                Eigen::MatrixXd C(p, q), AC(n, q);
                kernels().dense.transposedProduct(A.data(), n, B.data(), n, C.data(), p, n, p, q);
                kernels().dense.product(A.data(), n, C.data(), p, AC.data(), n, n, p, q);
                EXPECT_LT((C - A.transpose() * B).norm(), 1e-11) << n << ' ' << p << ' ' << q;
                EXPECT_LT((AC - A * C).norm(), 1e-10) << n << ' ' << p << ' ' << q;
            }
}

TEST_P(KernelsOfEverySet, MakesTheUpperHalfOfASquareProduct) {
    std::srand(4);
    const Index n = 700, m = 37;
    const Eigen::MatrixXd A = Eigen::MatrixXd::Random(n, m), B = Eigen::MatrixXd::Random(n, m);
    Eigen::MatrixXd C = Eigen::MatrixXd::Zero(m, m);
    kernels().dense.upperTransposedProduct(A.data(), n, B.data(), n, C.data(), m, n, m);
    const Eigen::MatrixXd all = A.transpose() * B;
    EXPECT_LT((C.triangularView<Eigen::Upper>().toDenseMatrix() -
               all.triangularView<Eigen::Upper>().toDenseMatrix())
                  .norm(),
              1e-11);
}

TEST_P(KernelsOfEverySet, SolvesSmallEigenproblems) {
    std::srand(7);
    for (const Index m : {1, 2, 9, 80}) {
        const Eigen::MatrixXd R = Eigen::MatrixXd::Random(m, m), Q = Eigen::MatrixXd::Random(m, m);
        const Eigen::MatrixXd A = R + R.transpose(), I = Eigen::MatrixXd::Identity(m, m);
        const Eigen::MatrixXd B = Q * Q.transpose() + I;
        Eigen::VectorXd values(m);
        Eigen::MatrixXd Z(m, m);
        ASSERT_TRUE(kernels().eigen.symmetric(A.data(), m, values.data(), Z.data()));
        EXPECT_LT((A * Z - Z * values.asDiagonal()).norm(), 1e-12 * A.norm());
        EXPECT_LT((Z.transpose() * Z - I).norm(), 1e-12);
        EXPECT_TRUE(std::is_sorted(values.begin(), values.end()));
        ASSERT_TRUE(kernels().eigen.generalized(A.data(), B.data(), m, values.data(), Z.data()));
        EXPECT_LT((A * Z - B * Z * values.asDiagonal()).norm(), 1e-11 * A.norm());
        EXPECT_LT((Z.transpose() * B * Z - I).norm(), 1e-12 * B.norm());
        EXPECT_TRUE(std::is_sorted(values.begin(), values.end()));
    }
}

TEST_P(KernelsOfEverySet, SaysWhenAMatrixIsNotPositiveDefinite) {
    const Eigen::MatrixXd A = Eigen::MatrixXd::Identity(2, 2), B = -A;
    Eigen::VectorXd values(2);
    Eigen::MatrixXd Z(2, 2);
    EXPECT_FALSE(kernels().eigen.generalized(A.data(), B.data(), 2, values.data(), Z.data()));
    Eigen::Matrix2d nearlySingular = Eigen::Matrix2d::Ones();
    nearlySingular(1, 1) += 2.3e-16;
    EXPECT_FALSE(
        kernels().eigen.generalized(A.data(), nearlySingular.data(), 2, values.data(), Z.data()));
}

/// A front in memory, as it is documented.
class FrontOf {
  public:
    FrontOf(const Eigen::MatrixXd& A, Index width)
        : offset_((kFrontLane - width % kFrontLane) % kFrontLane),
          below_(A.rows() - width),
          padded_((below_ + kFrontLane - 1) / kFrontLane * kFrontLane),
          panel_(Eigen::MatrixXd::Zero(offset_ + width + padded_, width)),
          update_(Eigen::MatrixXd::Zero(padded_, below_)),
          scratch_(panel_.rows(), width) {
        panel_.middleRows(offset_, A.rows()) = A.leftCols(width).triangularView<Eigen::Lower>();
        update_.topRows(below_) =
            A.bottomRightCorner(below_, below_).triangularView<Eigen::Lower>();
    }

    DenseFront front() {
        return {panel_.cols(), below_,         panel_.data(),  panel_.rows(),
                offset_,       update_.data(), scratch_.data()};
    }

    /// The columns of L with the pivots in place of the ones.
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

TEST_P(KernelsOfEverySet, EliminatesInFronts) {
    std::srand(9);
    for (const Index width : {1, 2, 3, 4, 5, 9, 18, 67})
        for (const Index below : {0, 1, 3, 4, 7, 31, 70}) {
            const Index n = width + below;
            // Indefinite, and of diagonal dominance: no pivot is small.
            Eigen::MatrixXd A = Eigen::MatrixXd::Random(n, n);
            A = (A + A.transpose()).eval();
            for (Index i = 0; i < n; ++i)
                A(i, i) = (i % 3 == 0 ? -3.0 : 3.0) * static_cast<double>(n + i);
            FrontOf front(A, width);
            ASSERT_TRUE(kernels().fronts.eliminate(front.front()));
            Eigen::MatrixXd L = front.columns();
            const Eigen::VectorXd pivots = L.diagonal();
            L.diagonal().setOnes();
            Eigen::MatrixXd product = L * pivots.asDiagonal() * L.transpose();
            product.bottomRightCorner(below, below) += front.update();
            EXPECT_LT((product - A).norm(), 1e-13 * A.norm()) << width << ' ' << below;
        }
}

TEST_P(KernelsOfEverySet, SaysWhenAPivotVanishes) {
    Eigen::MatrixXd A = Eigen::MatrixXd::Ones(7, 7);
    A.diagonal() << 1.0, 1.0, 3.0, 4.0, 5.0, 6.0, 7.0;
    FrontOf one(A, 1), five(A, 5);
    EXPECT_TRUE(kernels().fronts.eliminate(one.front()));
    EXPECT_FALSE(kernels().fronts.eliminate(five.front()));
}

/// LdltFactor::joined, from the rows themselves.
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

class SparseKernelsOfEverySet : public KernelsOfEverySet {
  protected:
    const testing::Operator A_{testing::withNoise(testing::icosphere(3), 0.03, 5)};
    const Index n_ = A_.laplacian.W.rows();
};

INSTANTIATE_TEST_SUITE_P(Widest, SparseKernelsOfEverySet,
                         ::testing::Range(std::size_t{0}, availableKernels().size()));

TEST_P(SparseKernelsOfEverySet, MultipliesASparseMatrix) {
    std::srand(5);
    const SparseMatrix& W = A_.laplacian.W;
    const SymmetricSparse matrix{n_, W.outerIndexPtr(), W.innerIndexPtr(), W.valuePtr()};
    for (const Index columns : {1, 7, 8, 21}) {
        const Eigen::MatrixXd S = Eigen::MatrixXd::Random(n_, columns);
        Eigen::MatrixXd WS(n_, columns);
        kernels().sparse.product(matrix, S.data(), n_, columns, WS.data(), n_);
        EXPECT_LT((WS - W * S).norm(), 1e-11 * WS.norm()) << columns << " columns";
    }
}

TEST_P(SparseKernelsOfEverySet, MeasuresResiduals) {
    std::srand(8);
    const auto& [W, D] = A_.laplacian;
    const SymmetricSparse matrix{n_, W.outerIndexPtr(), W.innerIndexPtr(), W.valuePtr()};
    for (const Index columns : {1, 7, 8, 21}) {
        const Eigen::MatrixXd S = Eigen::MatrixXd::Random(n_, columns);
        const Eigen::VectorXd lambda = Eigen::VectorXd::Random(columns);
        Eigen::VectorXd squares(columns);
        kernels().sparse.squaredResiduals(matrix, D.data(), S.data(), n_, columns, lambda.data(),
                                          squares.data());
        const Eigen::MatrixXd R = W * S - D.asDiagonal() * S * lambda.asDiagonal();
        const Eigen::VectorXd expected =
            (D.cwiseSqrt().cwiseInverse().asDiagonal() * R).colwise().squaredNorm();
        EXPECT_LT((squares - expected).norm(), 1e-12 * expected.norm()) << columns << " columns";
    }
}

TEST_P(SparseKernelsOfEverySet, AddsWhatPanelsContributeToRitzProducts) {
    std::srand(10);
    const auto& [W, D] = A_.laplacian;
    std::vector<int> order(static_cast<std::size_t>(n_));
    std::iota(order.begin(), order.end(), 0);
    const RowPanels rows(A_.laplacian, order, 0, n_);
    const std::vector<RowPanel> panels = rows.panels();
    ASSERT_GT(panels.size(), 2u);
    for (const Index m : {1, 8, 16, 37}) {
        const Eigen::MatrixXd S = Eigen::MatrixXd::Random(n_, m);
        Eigen::MatrixXd H = Eigen::MatrixXd::Ones(m, m), G = 2.0 * H;
        kernels().panels.add(panels.data(), static_cast<Index>(panels.size()), S.data(), n_, m,
                             H.data(), G.data());
        Eigen::MatrixXd expectedH = S.transpose() * (W * S);
        Eigen::MatrixXd expectedG = S.transpose() * D.asDiagonal() * S;
        expectedH.array() += 1.0;
        expectedG.array() += 2.0;
        for (Index j = 0; j < m; ++j) {
            EXPECT_LT((H - expectedH).col(j).head(j + 1).norm(), 1e-12 * expectedH.norm()) << m;
            EXPECT_LT((G - expectedG).col(j).head(j + 1).norm(), 1e-12 * expectedG.norm()) << m;
        }
    }
}

TEST_P(SparseKernelsOfEverySet, SolvesWithAFactorization) {
    std::srand(6);
    SparseMatrix shifted = A_.laplacian.W;
    shifted.diagonal() -= 7.0 * A_.laplacian.D;
    const Eigen::SimplicialLDLT<SparseMatrix> ldlt(shifted);
    const SparseMatrix L = ldlt.matrixL().nestedExpression();
    const Eigen::VectorXd pivots = ldlt.vectorD();
    const std::vector<char> joined = joinedColumns(L);
    const LdltFactor factor{L.outerIndexPtr(), L.outerIndexPtr(), L.innerIndexPtr(), L.valuePtr(),
                            joined.data()};
    for (const int columns : {1, 2, 3, 4, 8, kMostRightHandSides}) {
        const Eigen::MatrixXd B = Eigen::MatrixXd::Random(n_, columns);
        Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> Y =
            ldlt.permutationP() * B;
        kernels().triangular.eliminate(factor, Y.data(), columns, 0, n_);
        Y = pivots.cwiseInverse().asDiagonal() * Y;
        kernels().triangular.substitute(factor, Y.data(), columns, 0, n_);
        const Eigen::MatrixXd X = ldlt.permutationPinv() * Eigen::MatrixXd(Y);
        EXPECT_LT((shifted * X - B).norm(), 1e-9 * B.norm()) << columns << " columns";
    }
}

}  // namespace
}  // namespace spectral
