#include "core/harmonics/harmonic_basis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/harmonics/truncated_basis.h"
#include "core/laplacian/laplacian_builder.h"
#include "core/mesh/mesh.h"
#include "core/support/errors.h"
#include "core/transfer/transfer_function.h"
#include "support/evaluation.h"

namespace spectral {
namespace {

using testing::lowestHarmonics;
using testing::Mesh;
using testing::Operator;
using testing::orthonormalityError;

/// Largest |W phi - lambda D phi| in the D^-1 norm, relative to the largest eigenvalue of the
/// basis.
double residual(const Operator& A, const HarmonicBasis& basis) {
    const Eigen::VectorXd& D = A.D;
    const Eigen::MatrixXd R =
        A.W * basis.Phi - D.asDiagonal() * basis.Phi * basis.lambda.asDiagonal();
    return (D.cwiseSqrt().cwiseInverse().asDiagonal() * R).colwise().norm().maxCoeff() /
           basis.lambda[basis.size() - 1];
}

/// Worst relative error of the sphere's eigenvalues l(l+1), l = 1 to maxDegree.
double sphereError(int levels, int maxDegree) {
    const Operator A(testing::icosphere(levels));
    const HarmonicBasis basis = lowestHarmonics(A, (maxDegree + 1) * (maxDegree + 1));
    double worst = 0.0;
    for (int l = 1; l <= maxDegree; ++l)
        for (int i = l * l; i < (l + 1) * (l + 1); ++i)
            worst = std::max(worst, std::abs(basis.lambda[i] / (l * (l + 1.0)) - 1.0));
    return worst;
}

TEST(TruncatedBasis, ConvergesToTheSpheresEigenvaluesAtSecondOrder) {
    const double coarse = sphereError(3, 4), middle = sphereError(4, 4), fine = sphereError(5, 4);
    EXPECT_LT(coarse, 0.03);
    EXPECT_NEAR(coarse / middle, 4.0, 0.2);
    EXPECT_NEAR(middle / fine, 4.0, 0.1);
}

TEST(TruncatedBasis, NeverSplitsTheSpheresMultiplets) {
    const Operator A(testing::icosphere(4));
    // Every k that is not a square splits a 2l+1-fold eigenvalue.
    for (const Index k : {2, 3, 5, 8, 10, 13, 17, 20, 26, 33, 50}) {
        const Index kept = lowestHarmonics(A, k).size();
        const Index root = std::lround(std::sqrt(static_cast<double>(kept)));
        EXPECT_EQ(root * root, kept) << "asked for " << k;
        EXPECT_GE(kept, k);
    }
}

/// Worst relative error of the 15 lowest eigenvalues pi^2 (p^2/a^2 + q^2/b^2) after the constant.
double rectangleError(int cells) {
    const double a = 2.0, b = 1.0;
    const Operator A(testing::rectangle(a, b, 2 * cells, cells));
    std::vector<double> exact;
    for (int p = 0; p < 12; ++p)
        for (int q = 0; q < 12; ++q)
            exact.push_back(kPi * kPi * (p * p / (a * a) + q * q / (b * b)));
    std::sort(exact.begin(), exact.end());
    const HarmonicBasis basis = lowestHarmonics(A, 16);
    double worst = 0.0;
    for (int i = 1; i < 16; ++i)
        worst = std::max(worst, std::abs(basis.lambda[i] / exact[i] - 1.0));
    return worst;
}

TEST(TruncatedBasis, ConvergesToTheRectanglesNeumannEigenvaluesAtSecondOrder) {
    const double coarse = rectangleError(16), middle = rectangleError(32),
                 fine = rectangleError(64);
    EXPECT_LT(coarse, 0.05);
    EXPECT_NEAR(coarse / middle, 4.0, 0.2);
    EXPECT_NEAR(middle / fine, 4.0, 0.1);
}

TEST(TruncatedBasis, NeverSplitsTheSquaresMultipleEigenvalues) {
    const Operator A(testing::rectangle(1.0, 1.0, 32, 32));
    // Neumann: 0 | (1,0) (0,1) | (1,1) | (2,0) (0,2) | (2,1) (1,2) | (2,2) | (3,0) (0,3) | ...
    // The lumped grid's eigenvalues are those of the 5-point stencil: (p,q) and (q,p) agree.
    for (const auto& [asked, kept] :
         {std::pair<Index, Index>{2, 3}, {3, 3}, {4, 4}, {5, 6}, {7, 8}})
        EXPECT_EQ(lowestHarmonics(A, asked).size(), kept) << "asked for " << asked;
}

TEST(TruncatedBasis, ToleratesATriangleOfAlmostNoArea) {
    // It touches the surface at one vertex only. The masses of its other two are 1e-12 of the mean,
    // which makes the largest eigenvalues 1e12 times those of the surface.
    Mesh mesh = testing::withNoise(testing::rectangle(2, 1, 22, 15), 0.01, 3);
    const Index n = mesh.V.rows();
    mesh.V.conservativeResize(n + 2, 3);
    mesh.V.bottomRows(2).rowwise() = mesh.V.row(n / 2).eval();
    mesh.V(n, 0) += 1e-8;
    mesh.V(n + 1, 1) += 1e-8;
    mesh.F.conservativeResize(mesh.F.rows() + 1, 3);
    mesh.F.bottomRows(1) << static_cast<int>(n / 2), static_cast<int>(n), static_cast<int>(n + 1);
    const Surface surface = surfaceOf(mesh.V, mesh.F);
    const Laplacian laplacian =
        LaplacianBuilder(surface, connectedComponents(surface.F, surface.X.rows()),
                         LaplacianKind::IntrinsicDelaunay, BasisUpdate::None)
            .current();
    ShiftedLdlt ldlt;
    const HarmonicBasis basis = truncatedBasis(laplacian, 40, ldlt);
    EXPECT_LT(basis.residuals.maxCoeff(), 1e-8);
}

TEST(TruncatedBasis, ContainsTheConstantOfEveryComponentExactly) {
    const Operator A(testing::joined(testing::joined(testing::blob(), testing::icosphere(1)),
                                     testing::torus(2, 0.7, 12, 8)));
    const HarmonicBasis basis = lowestHarmonics(A, 12);
    EXPECT_TRUE((basis.lambda.head(3).array() == 0.0).all());
    EXPECT_GT(basis.lambda[3], 0.0);
}

TEST(TruncatedBasis, RejectsASizeTooLargeForTheMesh) {
    const Operator A(testing::icosphere(1));
    EXPECT_THROW(lowestHarmonics(A, 42), InvalidOption);
    EXPECT_THROW(lowestHarmonics(A, 1), InvalidOption);
    EXPECT_EQ(lowestHarmonics(A, 41).size(), 41);
}

TEST(DenseBasis, DiagonalizesTheLaplacian) {
    const Operator A(testing::blob());
    const HarmonicBasis basis = denseBasis(A);
    EXPECT_EQ(basis.size(), A.mesh.V.rows());
    EXPECT_LT(orthonormalityError(basis.Phi, A.D), 1e-12);
    EXPECT_LT(residual(A, basis), 1e-12);
}

TEST(LargestEigenvalue, AgreesWithTheDenseSolver) {
    for (const Mesh& mesh : {testing::blob(), testing::icosphere(2), testing::icosphere(0)}) {
        const Operator A(mesh);
        const Eigen::VectorXd lambda = denseBasis(A).lambda;
        EXPECT_NEAR(largestEigenvalue(A) / lambda[lambda.size() - 1], 1.0, 1e-7);
    }
}

TEST(ApplyInBasis, WithAllPairsEqualsDense) {
    const Operator A(testing::blob());
    const HarmonicBasis dense = denseBasis(A);
    const Gain gain = fractionalPower(TransferFunction({}, 5.0), 1.0);
    // With all n harmonics there is no residual.
    const Eigen::MatrixXd with = applyInBasis(dense, A, gain, 0.7, A.mesh.V);
    EXPECT_LT((with - testing::filteredDense(A, dense, gain)).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(ApplyInBasis, ResidualGainActsBeyondTheBasis) {
    const Operator A(testing::blob());
    const HarmonicBasis dense = denseBasis(A);
    const HarmonicBasis basis = lowestHarmonics(A, 40);
    const double cut =
        std::sqrt(0.5 * (dense.lambda[basis.size() - 1] + dense.lambda[basis.size()]));
    const Eigen::MatrixXd Y = applyInBasis(basis, A, [](double) { return 1.0; }, 0.25, A.mesh.V);
    const Vertices expected =
        testing::filteredDense(A, dense, [cut](double omega) { return omega < cut ? 1.0 : 0.25; });
    EXPECT_LT((Y - expected).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(DenseBasis, IsOrthogonalToTheConstantsOfEveryComponent) {
    // The largest eigenvalue, that of the small sphere, is 1e10 times the lowest: round-off in the
    // eigenvalues of the constants is about as large as the lowest.
    Mesh small = testing::icosphere(1);
    small.V *= 1e-5;
    const Operator A(testing::joined(testing::joined(testing::icosphere(2), small), small));
    const HarmonicBasis dense = denseBasis(A);
    EXPECT_LT(orthonormalityError(dense.Phi, A.D), 1e-10);
    EXPECT_EQ(dense.lambda.head(A.constants.count()).cwiseAbs().maxCoeff(), 0.0);
}

TEST(DenseBasis, IsThatOfAnIntervalOnARibbon) {
    // The largest eigenvalue is 1e14 times the lowest: its round-off is as large as the lowest.
    const auto lowestOf = [](double height) {
        const Operator A(testing::rectangle(1.0, height, 10, 1));
        return Eigen::VectorXd(denseBasis(A).lambda.segment(1, 9));
    };
    EXPECT_LT((lowestOf(1e-7).cwiseQuotient(lowestOf(1e-4)).array() - 1.0).abs().maxCoeff(), 1e-6);
}

TEST(LargestEigenvalue, ScalesWithTheMesh) {
    Mesh mesh = testing::torus(2, 0.7, 24, 12);
    const double expected = largestEigenvalue(Operator(mesh));
    for (const double scale : {1e9, 1e-9, 1e30}) {
        Mesh scaled = mesh;
        scaled.V *= scale;
        EXPECT_NEAR(largestEigenvalue(Operator(scaled)) * scale * scale, expected, 1e-7 * expected);
    }
}

TEST(LargestEigenvalue, IsTheDiagonalEntryOfAVertexOfTinyMass) {
    for (const int levels : {0, 3}) {
        Laplacian light = Operator(testing::icosphere(levels));
        for (light.D[0] *= 1e-9; light.D[0] > 1e-24; light.D[0] *= 0.3)
            EXPECT_NEAR(largestEigenvalue(light) * light.D[0] / light.W.coeff(0, 0), 1.0, 1e-7)
                << light.D[0];
    }
}

TEST(LargestEigenvalue, ThrowsSolverFailureOnOverflow) {
    const Operator A(testing::blob());
    for (const double factor : {1e200, 1e308, std::numeric_limits<double>::quiet_NaN()}) {
        Laplacian huge = A;
        huge.W *= factor;
        huge.D *= 1e-200;
        EXPECT_THROW(largestEigenvalue(huge), SolverFailure) << factor;
    }
}

}  // namespace
}  // namespace spectral
