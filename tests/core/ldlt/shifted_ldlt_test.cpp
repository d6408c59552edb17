#include "core/ldlt/shifted_ldlt.h"

#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>
#include <cstdlib>
#include <limits>

#include "core/support/errors.h"
#include "support/evaluation.h"
#include "support/shapes.h"

namespace spectral {
namespace {

using testing::Operator;

Operator lumpySphere(int subdivisions) {
    return Operator(testing::withNoise(testing::icosphere(subdivisions), 0.03, 5));
}

SparseMatrix shifted(const Laplacian& laplacian, double sigma) {
    SparseMatrix A = laplacian.W;
    A.diagonal() -= sigma * laplacian.D;
    return A;
}

double relativeResidual(const ShiftedLdlt& ldlt, const Laplacian& laplacian) {
    const Eigen::MatrixXd B = Eigen::MatrixXd::Random(laplacian.W.rows(), 5);
    return (shifted(laplacian, ldlt.shift()) * ldlt.solve(B) - B).norm() / B.norm();
}

TEST(ShiftedLdlt, SolvesWithinTheSpectrumAndBelowIt) {
    std::srand(1);
    for (const int subdivisions : {0, 1, 2, 4}) {
        const Operator A = lumpySphere(subdivisions);
        ShiftedLdlt ldlt;
        for (const double sigma : {-3.0, 7.0, 25.0}) {
            ldlt.factorize(A.laplacian, sigma);
            EXPECT_EQ(ldlt.shift(), sigma);
            EXPECT_LT(relativeResidual(ldlt, A.laplacian), 1e-9) << subdivisions << ' ' << sigma;
        }
    }
}

TEST(ShiftedLdlt, CountsAsEigenDoes) {
    const Operator A = lumpySphere(3);
    ShiftedLdlt ldlt;
    for (const double sigma : {-1.0, 1e-3, 1.0, 5.0, 30.0, 1e3, 1e6}) {
        ldlt.factorize(A.laplacian, sigma);
        const Eigen::SimplicialLDLT<SparseMatrix> eigen(shifted(A.laplacian, sigma));
        EXPECT_EQ(ldlt.eigenvaluesBelow(), (eigen.vectorD().array() < 0.0).count()) << sigma;
    }
}

TEST(ShiftedLdlt, TakesMatricesOfOtherPatterns) {
    std::srand(2);
    ShiftedLdlt ldlt;
    for (const int subdivisions : {2, 3, 1, 2}) {
        const Operator A = lumpySphere(subdivisions);
        ldlt.factorize(A.laplacian, 4.0);
        EXPECT_LT(relativeResidual(ldlt, A.laplacian), 1e-9) << subdivisions;
    }
    // As many vertices and edges as before, otherwise connected.
    Operator A = lumpySphere(2);
    const Eigen::Index n = A.laplacian.W.rows();
    Eigen::PermutationMatrix<Eigen::Dynamic> reversed(n);
    for (Eigen::Index i = 0; i < n; ++i) reversed.indices()[i] = static_cast<int>(n - 1 - i);
    const SparseMatrix PW = reversed * A.laplacian.W;
    A.laplacian.W = PW * reversed.transpose();
    A.laplacian.D = (reversed * A.laplacian.D).eval();
    ldlt.factorize(A.laplacian, 4.0);
    EXPECT_LT(relativeResidual(ldlt, A.laplacian), 1e-9);
}

TEST(ShiftedLdlt, TakesAMatrixOfSeveralParts) {
    std::srand(3);
    Laplacian laplacian;
    laplacian.W.resize(9, 9);  // three paths, and an entry alone
    for (const int i : {0, 1, 3, 5, 6}) {
        laplacian.W.coeffRef(i, i + 1) = laplacian.W.coeffRef(i + 1, i) = -1.0;
        laplacian.W.coeffRef(i, i) += 1.0;
        laplacian.W.coeffRef(i + 1, i + 1) += 1.0;
    }
    laplacian.W.coeffRef(8, 8) = 2.0;
    laplacian.W.makeCompressed();
    laplacian.D = Eigen::VectorXd::LinSpaced(9, 1.0, 2.0);
    ShiftedLdlt ldlt;
    ldlt.factorize(laplacian, -0.5);
    EXPECT_LT(relativeResidual(ldlt, laplacian), 1e-14);
    EXPECT_EQ(ldlt.eigenvaluesBelow(), 0);
}

TEST(ShiftedLdlt, MovesAShiftThatMakesAPivotVanish) {
    Laplacian laplacian;
    laplacian.W.resize(3, 3);
    for (int i = 0; i < 3; ++i) laplacian.W.insert(i, i) = 1.0 + i;
    laplacian.W.makeCompressed();
    laplacian.D = Eigen::VectorXd::Ones(3);
    ShiftedLdlt ldlt;
    ldlt.factorize(laplacian, 2.0);
    EXPECT_NE(ldlt.shift(), 2.0);
    EXPECT_NEAR(ldlt.shift(), 2.0, 1e-6);
    EXPECT_EQ(ldlt.eigenvaluesBelow(), 2);
    laplacian.W.coeffRef(1, 1) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(ldlt.factorize(laplacian, 2.0), SolverFailure);
}

}  // namespace
}  // namespace spectral
