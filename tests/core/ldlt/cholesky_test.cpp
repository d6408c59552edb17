#include "core/ldlt/cholesky.h"

#include <gtest/gtest.h>

#include "core/harmonics/harmonic_basis.h"
#include "core/laplacian/constant_modes.h"
#include "core/mesh/components.h"
#include "core/mesh/mesh.h"
#include "core/support/errors.h"
#include "support/shapes.h"

namespace spectral {
namespace {

using testing::Mesh;

TEST(ShiftedCholesky, SolvesEveryNumberOfColumns) {
    const Mesh mesh = testing::blob();
    const Laplacian laplacian = cotangentLaplacian(mesh.V, mesh.F);
    const double shift = 3.0;
    ShiftedCholesky cholesky;
    cholesky.factorize(laplacian, shift);
    const Eigen::MatrixXd A =
        Eigen::MatrixXd(laplacian.W) + Eigen::MatrixXd(shift * laplacian.D.asDiagonal());
    for (int columns = 1; columns <= 9; ++columns) {
        const Eigen::MatrixXd X =
            testing::withNoise({Vertices::Zero(mesh.V.rows() * columns, 3), mesh.F}, 1.0, 5)
                .V.col(0)
                .reshaped(mesh.V.rows(), columns);
        const Eigen::MatrixXd solution = cholesky.solve(A * X);
        EXPECT_LT((solution - X).cwiseAbs().maxCoeff(), 1e-12);
    }
    EXPECT_EQ(cholesky.factorizations(), 1);
    EXPECT_EQ(cholesky.solves(), 45);
}

TEST(ShiftedCholesky, FollowsAChangedPattern) {
    ShiftedCholesky cholesky;
    for (const Mesh& mesh : {testing::blob(), testing::torus(2, 1, 20, 10), testing::blob()}) {
        const Laplacian laplacian = cotangentLaplacian(mesh.V, mesh.F);
        cholesky.factorize(laplacian, 1.0);
        const Eigen::MatrixXd X = mesh.V;
        const Eigen::MatrixXd B = laplacian.W * X + laplacian.D.asDiagonal() * X;
        EXPECT_LT((cholesky.solve(B) - X).cwiseAbs().maxCoeff(), 1e-11);
    }
}

TEST(ShiftedCholesky, RefusesAnIndefiniteMatrix) {
    const Mesh mesh = testing::blob();
    ShiftedCholesky cholesky;
    EXPECT_THROW(cholesky.factorize(cotangentLaplacian(mesh.V, mesh.F), -50.0), SolverFailure);
}

TEST(ShiftedCholesky, CountsEigenvaluesBelowAShiftExactly) {
    for (const Mesh& mesh :
         {testing::blob(), testing::icosphere(2), testing::rectangle(3, 1, 24, 8)}) {
        const Laplacian laplacian = cotangentLaplacian(mesh.V, mesh.F);
        const ConstantModes constants(connectedComponents(mesh.F, mesh.V.rows()), laplacian.D);
        const Eigen::VectorXd lambda = denseBasis(laplacian, constants).lambda;
        ShiftedCholesky cholesky;
        for (const double part : {0.0007, 0.013, 0.11, 0.47, 0.93}) {
            const double sigma = part * lambda[lambda.size() - 1];
            EXPECT_EQ(cholesky.countEigenvaluesBelow(laplacian, sigma),
                      (lambda.array() < sigma).count());
        }
    }
}

TEST(ShiftedCholesky, KeepsItsFactorWhileAnotherPatternIsCounted) {
    const Mesh mesh = testing::blob(), other = testing::torus(2, 1, 20, 10);
    const Laplacian laplacian = cotangentLaplacian(mesh.V, mesh.F);
    ShiftedCholesky cholesky;
    cholesky.factorize(laplacian, 1.0);
    const Eigen::MatrixXd before = cholesky.solve(mesh.V);
    cholesky.countEigenvaluesBelow(cotangentLaplacian(other.V, other.F), 0.3);
    EXPECT_EQ(cholesky.solve(mesh.V), before);
}

}  // namespace
}  // namespace spectral
