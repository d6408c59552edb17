#include "core/krylov/krylov_spaces.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <vector>

#include "support/evaluation.h"

namespace spectral {
namespace {

using testing::Mesh;
using testing::Operator;

/// Spectral measure of the x coordinate, from a Krylov space of the given dimension.
struct Measured {
    Quadrature measure;
    bool canBeExtended = false;
};
Measured measured(const Operator& A, double pole, int dimensions) {
    ShiftedLdlt ldlt;
    ldlt.factorizeDefinite(A.W, A.D, pole);
    const ShiftInvert S(ldlt);
    KrylovSpaces space(S, A, A.mesh.V.leftCols(1));
    for (int m = 0; m < dimensions; ++m) space.extend();
    return {space.quadrature(0), space.extend()};
}

TEST(KrylovSpaces, StayOrthogonalToConstantsAndToThemselves) {
    // S amplifies constants more than anything else, and the coordinates are almost harmonics.
    const Operator A(testing::joined(testing::blob(), testing::icosphere(3)));
    for (const double pole : {0.5, 50.0}) {
        ShiftedLdlt ldlt;
        ldlt.factorizeDefinite(A.W, A.D, pole);
        const ShiftInvert S(ldlt);
        KrylovSpaces spaces(S, A, A.mesh.V);
        const int dimensions = 80;
        for (int m = 0; m < dimensions; ++m) spaces.extend();
        const auto vector = [&](int m) {
            return spaces.combine({3, Eigen::VectorXd::Unit(dimensions, m)});
        };
        const Eigen::MatrixXd last = vector(dimensions - 1);
        EXPECT_LT(A.constants.means(A.D, last).cwiseAbs().maxCoeff(), 1e-12);
        for (int m = 0; m < dimensions; ++m) {
            const Eigen::VectorXd products =
                testing::innerProducts(vector(m), A.D, last).diagonal();
            const double expected = m == dimensions - 1 ? 1.0 : 0.0;
            EXPECT_LT((products.array() - expected).abs().maxCoeff(), 1e-8) << m;
        }
    }
}

TEST(KrylovSpaces, AreAsOrthogonalAsRequestedDespiteCancellation) {
    const Operator A(testing::rectangle(1.0, 1e-6, 7, 2));
    const int dimensions = 6;
    for (const double pole : {1e3, 1e6, 1e9})
        for (const double orthogonal : {1e-10, 1e-12, 1e-14}) {
            ShiftedLdlt ldlt;
            ldlt.factorizeDefinite(A.W, A.D, pole);
            const ShiftInvert S(ldlt);
            KrylovSpaces spaces(S, A, A.mesh.V.leftCols(1), orthogonal);
            for (int m = 0; m < dimensions; ++m) spaces.extend();
            Eigen::MatrixXd Q(A.mesh.V.rows(), dimensions);
            for (int m = 0; m < dimensions; ++m)
                Q.col(m) = spaces.combine({Eigen::VectorXd::Unit(dimensions, m)});
            EXPECT_LT(testing::orthonormalityError(Q, A.D), orthogonal) << pole;
        }
}

TEST(KrylovSpaces, AreNotOrthogonalizedWhileTheRecurrenceKeepsThemOrthogonal) {
    const Operator A(testing::blob());
    ShiftedLdlt ldlt;
    ldlt.factorizeDefinite(A.W, A.D, 50.0);
    const ShiftInvert S(ldlt);
    const double never = 2.0;
    KrylovSpaces recurrence(S, A, A.mesh.V.leftCols(1), never);
    KrylovSpaces spaces(S, A, A.mesh.V.leftCols(1));
    const int dimensions = 20;
    for (int m = 0; m < dimensions; ++m) {
        recurrence.extend();
        spaces.extend();
    }
    Eigen::MatrixXd Q(A.mesh.V.rows(), dimensions);
    for (int m = 0; m < dimensions; ++m) {
        const Eigen::VectorXd unit = Eigen::VectorXd::Unit(dimensions, m);
        Q.col(m) = recurrence.combine({unit});
        EXPECT_EQ(Q.col(m), spaces.combine({unit}).col(0)) << m;
    }
    EXPECT_LT(testing::orthonormalityError(Q, A.D), KrylovSpaces::kOrthogonal);
}

TEST(KrylovSpaces, AreNormalizedWhenRoundOffAddsConstantsToSolves) {
    // A ribbon: new directions are about as small as the round-off of S.
    const Operator A(testing::rectangle(1.0, 1e-7, 7, 2));
    ShiftedLdlt ldlt;
    ldlt.factorizeDefinite(A.W, A.D, 1e9);
    const ShiftInvert S(ldlt);
    KrylovSpaces spaces(S, A, A.mesh.V.leftCols(1));
    for (int m = 0; m < 6; ++m) spaces.extend();
    for (int m = 0; m < 6; ++m) {
        const Eigen::VectorXd q = spaces.combine({Eigen::VectorXd::Unit(6, m)});
        EXPECT_NEAR(q.dot(A.D.cwiseProduct(q)), 1.0, 1e-10) << m;
    }
}

TEST(KrylovSpaces, ReturnTheLargestEntryOfACombination) {
    const Operator A(testing::blob());
    ShiftedLdlt ldlt;
    ldlt.factorizeDefinite(A.W, A.D, 5.0);
    const ShiftInvert S(ldlt);
    KrylovSpaces spaces(S, A, A.mesh.V);
    for (int m = 0; m < 4; ++m) spaces.extend();
    std::srand(5);
    std::vector<Eigen::VectorXd> coefficients(3);
    for (int c = 0; c < 3; ++c) coefficients[c] = Eigen::VectorXd::Random(c + 1);
    EXPECT_EQ(spaces.largestEntryOf(coefficients),
              spaces.combine(coefficients).cwiseAbs().maxCoeff());
}

double integral(const Quadrature& measure, const Gain& f) {
    double sum = 0.0;
    for (Index i = 0; i < measure.omega.size(); ++i) sum += measure.weight[i] * f(measure.omega[i]);
    return sum;
}

TEST(LanczosQuadrature, IsExactForPolynomialsBelowTwiceItsDimension) {
    const Operator A(testing::blob());
    const HarmonicBasis dense = denseBasis(A);
    Eigen::VectorXd c = testing::innerProducts(dense.Phi, A.D, A.mesh.V.col(0));
    c[0] = 0.0;
    const double pole = 20.0;
    const int m = 5;
    const Quadrature measure = measured(A, pole, m).measure;
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

TEST(LanczosQuadrature, IsTheSpectralMeasureInAnInvariantSpace) {
    const Operator A(testing::icosphere(0));  // its coordinates are harmonics of one frequency
    const HarmonicBasis dense = denseBasis(A);
    const auto [measure, canBeExtended] = measured(A, 3.0, 4);
    EXPECT_FALSE(canBeExtended);
    ASSERT_EQ(measure.omega.size(), 1);
    EXPECT_NEAR(measure.omega[0], std::sqrt(dense.lambda[1]), 1e-12);
    EXPECT_NEAR(measure.weight[0], A.mesh.V.col(0).cwiseAbs2().dot(A.D), 1e-12);
}

TEST(LanczosQuadrature, IsTheSameAtAnyScaleOfTheMesh) {
    const double pole = 20.0;
    const Quadrature expected = measured(Operator(testing::blob()), pole, 12).measure;
    for (const double scale : {1e-7, 1e7}) {
        Mesh mesh = testing::blob();
        mesh.V *= scale;
        const Quadrature measure = measured(Operator(mesh), pole / (scale * scale), 12).measure;
        ASSERT_EQ(measure.omega.size(), expected.omega.size());
        // Energies of coordinates are lengths to the fourth power.
        EXPECT_LT((scale * measure.omega - expected.omega).cwiseAbs().maxCoeff(),
                  1e-12 * expected.omega.maxCoeff());
        EXPECT_LT((measure.weight / std::pow(scale, 4) - expected.weight).cwiseAbs().maxCoeff(),
                  1e-12 * expected.weight.sum());
    }
}

TEST(LanczosQuadrature, HasNoNodesForAConstantSignal) {
    const Operator A(testing::icosphere(0));
    ShiftedLdlt ldlt;
    ldlt.factorizeDefinite(A.W, A.D, 1.0);
    const ShiftInvert S(ldlt);
    KrylovSpaces space(S, A, Eigen::MatrixXd::Constant(A.mesh.V.rows(), 1, 5.0));
    EXPECT_FALSE(space.extend());
    EXPECT_EQ(space.quadrature(0).omega.size(), 0);
}

}  // namespace
}  // namespace spectral
