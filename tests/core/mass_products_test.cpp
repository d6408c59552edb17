#include "core/mass_products.h"

#include <gtest/gtest.h>

#include "core/types.h"

namespace spectral {
namespace {

/// Largest difference from the plain products, for A with p columns and B with q.
double error(Index n, Index p, Index q) {
    std::srand(7);
    const Eigen::MatrixXd A = Eigen::MatrixXd::Random(n, p), B = Eigen::MatrixXd::Random(n, q);
    const Eigen::VectorXd D = Eigen::VectorXd::Random(n).cwiseAbs();
    const Eigen::MatrixXd C = innerProducts(A, D, B);
    const double inner = (C - A.transpose() * D.asDiagonal() * B).norm();
    Eigen::MatrixXd rest = B;
    subtractProduct(A, C, rest);
    const double outer = (rest - (B - A * C)).norm();
    Eigen::MatrixXd product = A;
    if (q <= p) multiplyInPlace(product, C);
    return std::max({inner, outer, q <= p ? (product.leftCols(q) - A * C).norm() : 0.0});
}

TEST(MassProducts, AreThoseOfAnyShape) {
    for (const Index n : {1, 3, 64, 511, 512, 1030})
        for (const Index p : {1, 2, 5, 8, 19})
            for (const Index q : {1, 2, 3, 4, 5, 9})
                EXPECT_LT(error(n, p, q), 1e-9)
                    << n << " rows, " << p << " and " << q << " columns";
}

TEST(MassProducts, TheGramMatrixIsThatOfInnerProducts) {
    std::srand(8);
    for (const Index n : {1, 511, 512, 1030})
        for (const Index m : {1, 2, 5, 19}) {
            const Eigen::MatrixXd S = Eigen::MatrixXd::Random(n, m);
            const Eigen::VectorXd D = Eigen::VectorXd::Random(n).cwiseAbs();
            EXPECT_LT((gramMatrix(S, D) - S.transpose() * D.asDiagonal() * S).norm(), 1e-9)
                << n << " rows, " << m << " columns";
        }
}

TEST(MassProducts, OfNoColumnsAreEmpty) {
    const Eigen::MatrixXd none(20, 0);
    Eigen::MatrixXd B = Eigen::MatrixXd::Ones(20, 3);
    const Eigen::VectorXd D = Eigen::VectorXd::Ones(20);
    EXPECT_EQ(innerProducts(none, D, B).size(), 0);
    EXPECT_EQ(innerProducts(B, D, none).size(), 0);
    subtractProduct(none, Eigen::MatrixXd(0, 3), B);
    EXPECT_TRUE((B.array() == 1.0).all());
}

TEST(MassProducts, TakePartsOfLargerMatrices) {
    const Eigen::MatrixXd A = Eigen::MatrixXd::Random(600, 9);
    const Eigen::VectorXd D = Eigen::VectorXd::LinSpaced(600, 0.1, 2.0);
    const Eigen::MatrixXd C =
        innerProducts(A.block(7, 1, 500, 4), D.segment(7, 500), A.block(7, 6, 500, 2));
    const Eigen::MatrixXd expected =
        A.block(7, 1, 500, 4).transpose() * D.segment(7, 500).asDiagonal() * A.block(7, 6, 500, 2);
    EXPECT_LT((C - expected).norm(), 1e-12);
}

}  // namespace
}  // namespace spectral
