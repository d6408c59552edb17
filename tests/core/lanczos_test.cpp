#include "core/lanczos.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/evaluation.h"

namespace spectral {
namespace {

using testing::Operator;

/// A column for the x coordinate of a mesh after some dimensions.
LanczosColumn extended(const Operator& A, double pole, int dimensions) {
    ShiftedCholesky cholesky;
    cholesky.factorize(A.laplacian, pole);
    const Eigen::VectorXd sqrtD = A.laplacian.D.cwiseSqrt();
    Eigen::MatrixXd x = A.mesh.V.col(0);
    A.constants.remove(x);
    std::vector<LanczosColumn> columns{LanczosColumn(sqrtD.cwiseProduct(x.col(0)))};
    for (int m = 0; m < dimensions; ++m) extendColumns(columns, sqrtD, A.constants, cholesky);
    return columns[0];
}

double integral(const Quadrature& measure, const Gain& f) {
    double sum = 0.0;
    for (Index i = 0; i < measure.omega.size(); ++i) sum += measure.weight[i] * f(measure.omega[i]);
    return sum;
}

TEST(LanczosQuadrature, IsExactForPolynomialsOfTwiceItsDimension) {
    const Operator A(testing::blob());
    const HarmonicBasis dense = denseBasis(A.laplacian, A.constants);
    Eigen::VectorXd c = dense.Phi.transpose() * A.laplacian.D.asDiagonal() * A.mesh.V.col(0);
    c[0] = 0.0;
    const double pole = 20.0;
    const int m = 5;
    const Quadrature measure = extended(A, pole, m).quadrature(pole);
    ASSERT_EQ(measure.omega.size(), m);
    EXPECT_GE(measure.weight.minCoeff(), 0.0);
    for (int degree = 0; degree <= 2 * m; ++degree) {
        const Gain f = [&](double omega) {
            return std::pow(pole / (omega * omega + pole), degree);
        };
        double expected = 0.0;
        for (Index i = 0; i < c.size(); ++i)
            expected += c[i] * c[i] * f(std::sqrt(dense.lambda[i]));
        const double error = std::abs(integral(measure, f) / expected - 1.0);
        if (degree < 2 * m)
            EXPECT_LT(error, 1e-11) << "degree " << degree;
        else
            EXPECT_GT(error, 1e-11) << "the test would pass whatever the degree";
    }
}

TEST(LanczosQuadrature, OfAnInvariantSpaceIsTheSpectralMeasure) {
    const Operator A(testing::icosphere(0));  // its coordinates are harmonics of one frequency
    const HarmonicBasis dense = denseBasis(A.laplacian, A.constants);
    const LanczosColumn column = extended(A, 3.0, 4);
    EXPECT_TRUE(column.exhausted());
    const Quadrature measure = column.quadrature(3.0);
    ASSERT_EQ(measure.omega.size(), 1);
    EXPECT_NEAR(measure.omega[0], std::sqrt(dense.lambda[1]), 1e-12);
    EXPECT_NEAR(measure.weight[0], A.mesh.V.col(0).cwiseAbs2().dot(A.laplacian.D), 1e-12);
}

TEST(LanczosQuadrature, OfNothingHasNoNodes) {
    const Operator A(testing::icosphere(0));
    const LanczosColumn column(Eigen::VectorXd::Zero(A.mesh.V.rows()));
    EXPECT_TRUE(column.exhausted());
    EXPECT_EQ(column.quadrature(1.0).omega.size(), 0);
}

}  // namespace
}  // namespace spectral
