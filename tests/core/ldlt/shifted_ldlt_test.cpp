#include "core/ldlt/shifted_ldlt.h"

#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>
#include <cstdlib>
#include <limits>
#include <vector>

#include "core/harmonics/harmonic_basis.h"
#include "core/support/errors.h"
#include "core/support/threads.h"
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

TEST(ShiftedLdlt, SolvesInsideAndBelowTheSpectrum) {
    std::srand(1);
    for (const int subdivisions : {0, 1, 2, 4}) {
        const Operator A = lumpySphere(subdivisions);
        ShiftedLdlt ldlt;
        for (const double sigma : {-3.0, 7.0, 25.0}) {
            ldlt.factorize(A.W, A.D, sigma);
            EXPECT_EQ(ldlt.shift(), sigma);
            EXPECT_LT(relativeResidual(ldlt, A), 1e-9) << subdivisions << ' ' << sigma;
        }
    }
}

TEST(ShiftedLdlt, SolvesForEveryPattern) {
    std::srand(5);
    SparseMatrix diagonal(5, 5);
    diagonal.setIdentity();
    std::vector<Laplacian> all{{diagonal, Eigen::VectorXd::Ones(5)}};
    for (const auto& mesh :
         {testing::icosphere(0), testing::rectangle(2.0, 1.0, 23, 9), testing::cube(40),
          testing::joined(testing::torus(2.0, 1.0, 17, 9), testing::cube(3))})
        all.push_back(Operator(mesh));
    for (const Laplacian& laplacian : all)
        for (const int threads : {1, 3}) {
            const ThreadTeam team(threads);
            ShiftedLdlt ldlt;
            ldlt.factorize(laplacian.W, laplacian.D, -0.7);
            EXPECT_LT(relativeResidual(ldlt, laplacian), 1e-12);
        }
}

TEST(ShiftedLdlt, CountsTheSameEigenvaluesAsEigen) {
    const Operator A = lumpySphere(3);
    ShiftedLdlt ldlt;
    for (const double sigma : {-1.0, 1e-3, 1.0, 5.0, 30.0, 1e3, 1e6}) {
        ldlt.factorize(A.W, A.D, sigma);
        const Eigen::SimplicialLDLT<SparseMatrix> eigen(shifted(A, sigma));
        EXPECT_EQ(ldlt.eigenvaluesBelow(), (eigen.vectorD().array() < 0.0).count()) << sigma;
    }
}

TEST(ShiftedLdlt, AcceptsMatricesOfOtherPatterns) {
    std::srand(2);
    ShiftedLdlt ldlt;
    for (const int subdivisions : {2, 3, 1, 2}) {
        const Operator A = lumpySphere(subdivisions);
        ldlt.factorize(A.W, A.D, 4.0);
        EXPECT_LT(relativeResidual(ldlt, A), 1e-9) << subdivisions;
    }
    // As many vertices and edges as before, but connected differently.
    Operator A = lumpySphere(2);
    const Eigen::Index n = A.W.rows();
    Eigen::PermutationMatrix<Eigen::Dynamic> reversed(n);
    for (Eigen::Index i = 0; i < n; ++i) reversed.indices()[i] = static_cast<int>(n - 1 - i);
    const SparseMatrix PW = reversed * A.W;
    A.W = PW * reversed.transpose();
    A.D = (reversed * A.D).eval();
    ldlt.factorize(A.W, A.D, 4.0);
    EXPECT_LT(relativeResidual(ldlt, A), 1e-9);
}

/// The mesh with the edge opposite the first corner of every n-th triangle flipped.
testing::Mesh withFlips(testing::Mesh mesh, int every) {
    for (Eigen::Index s = 0; s < mesh.F.rows(); s += every) {
        const int i = mesh.F(s, 1), j = mesh.F(s, 2);
        for (Eigen::Index t = 0; t < mesh.F.rows(); ++t)
            for (int c = 0; c < 3; ++c) {
                if (mesh.F(t, c) != j || mesh.F(t, (c + 1) % 3) != i) continue;
                const int k = mesh.F(s, 0), l = mesh.F(t, (c + 2) % 3);
                mesh.F.row(s) << k, i, l;
                mesh.F.row(t) << l, j, k;
            }
    }
    return mesh;
}

TEST(ShiftedLdlt, AdaptsItsOrderToSimilarPatterns) {
    std::srand(6);
    const testing::Mesh mesh = testing::withNoise(testing::icosphere(4), 0.003, 5);
    const SymbolicLdlt before(Operator(mesh).W);
    for (const int threads : {1, 3}) {
        const ThreadTeam team(threads);
        ShiftedLdlt ldlt;
        for (const int every : {5000, 600, 80, 9}) {  // from one flip to a ninth of the triangles
            const Operator A(withFlips(mesh, every));
            const SymbolicLdlt adapted(A.W, &before);
            EXPECT_LT(adapted.valueStarts.back(), 1.25 * before.valueStarts.back()) << every;
            ldlt.factorize(A.W, A.D, 4.0);
            EXPECT_LT(relativeResidual(ldlt, A), 1e-9) << every;
        }
    }
    const SymbolicLdlt one(Operator(withFlips(mesh, 5000)).W, &before);
    const Eigen::VectorXi moved = (one.order - before.order).cwiseAbs();
    EXPECT_LT(moved.cast<double>().mean(), 2.0);
}

TEST(ShiftedLdlt, FindsANewOrderForDissimilarPatterns) {
    const SparseMatrix W = Operator(testing::icosphere(4)).W;
    const SymbolicLdlt before(W);
    Eigen::PermutationMatrix<Eigen::Dynamic> reversed(W.rows());
    for (Eigen::Index i = 0; i < W.rows(); ++i)
        reversed.indices()[i] = static_cast<int>(W.rows() - 1 - i);
    const SparseMatrix PW = reversed * W, other = PW * reversed.transpose();
    EXPECT_EQ(SymbolicLdlt(other, &before).valueStarts.back(),
              SymbolicLdlt(other).valueStarts.back());
}

TEST(ShiftedLdlt, SolvesForAMatrixOfSeveralComponents) {
    std::srand(3);
    Laplacian laplacian;
    laplacian.W.resize(9, 9);  // three paths and an isolated entry
    for (const int i : {0, 1, 3, 5, 6}) {
        laplacian.W.coeffRef(i, i + 1) = laplacian.W.coeffRef(i + 1, i) = -1.0;
        laplacian.W.coeffRef(i, i) += 1.0;
        laplacian.W.coeffRef(i + 1, i + 1) += 1.0;
    }
    laplacian.W.coeffRef(8, 8) = 2.0;
    laplacian.W.makeCompressed();
    laplacian.D = Eigen::VectorXd::LinSpaced(9, 1.0, 2.0);
    ShiftedLdlt ldlt;
    ldlt.factorize(laplacian.W, laplacian.D, -0.5);
    EXPECT_LT(relativeResidual(ldlt, laplacian), 1e-14);
    EXPECT_EQ(ldlt.eigenvaluesBelow(), 0);
}

TEST(ShiftedLdlt, PerturbsAShiftAtWhichAPivotVanishes) {
    Laplacian laplacian;
    laplacian.W.resize(3, 3);
    for (int i = 0; i < 3; ++i) laplacian.W.insert(i, i) = 1.0 + i;
    laplacian.W.makeCompressed();
    laplacian.D = Eigen::VectorXd::Ones(3);
    ShiftedLdlt ldlt;
    ldlt.factorize(laplacian.W, laplacian.D, 2.0);
    EXPECT_NE(ldlt.shift(), 2.0);
    EXPECT_NEAR(ldlt.shift(), 2.0, 1e-6);
    EXPECT_EQ(ldlt.eigenvaluesBelow(), 2);
    laplacian.W.coeffRef(1, 1) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(ldlt.factorize(laplacian.W, laplacian.D, 2.0), SolverFailure);
}

TEST(ShiftedLdlt, SolvesAnyNumberOfColumns) {
    std::srand(4);
    const Operator A = lumpySphere(3);
    ShiftedLdlt ldlt;
    ldlt.factorizeDefinite(A.W, A.D, 3.0);
    EXPECT_EQ(ldlt.shift(), -3.0);
    int solves = 0;
    for (int columns = 1; columns <= 19; ++columns) {
        const Eigen::MatrixXd X = Eigen::MatrixXd::Random(A.W.rows(), columns);
        const Eigen::MatrixXd B = shifted(A, -3.0) * X;
        EXPECT_LT((ldlt.solve(B) - X).cwiseAbs().maxCoeff(), 1e-11) << columns;
        solves += columns;
    }
    EXPECT_EQ(ldlt.factorizations(), 1);
    EXPECT_EQ(ldlt.solves(), solves);
}

TEST(ShiftedLdlt, RejectsAnIndefiniteMatrixThatMustBeDefinite) {
    const Operator A = lumpySphere(2);
    ShiftedLdlt ldlt;
    EXPECT_THROW(ldlt.factorizeDefinite(A.W, A.D, -50.0), SolverFailure);
}

TEST(ShiftedLdlt, CountsEigenvaluesBelowAShiftExactly) {
    for (const auto& mesh :
         {testing::blob(), testing::icosphere(2), testing::rectangle(3, 1, 24, 8)}) {
        const Operator A(mesh);
        const Eigen::VectorXd lambda = denseBasis(A).lambda;
        ShiftedLdlt ldlt;
        for (const double part : {0.0007, 0.013, 0.11, 0.47, 0.93}) {
            const double sigma = part * lambda[lambda.size() - 1];
            EXPECT_EQ(countEigenvaluesBelow(A.W, A.D, sigma, ldlt),
                      (lambda.array() < sigma).count());
        }
        EXPECT_EQ(ldlt.factorizations(), 5);
    }
}

TEST(ShiftedLdlt, KeepsItsFactorWhileASiblingCounts) {
    const Operator A(testing::blob()), other(testing::torus(2, 1, 20, 10));
    ShiftedLdlt ldlt;
    ldlt.factorizeDefinite(A.W, A.D, 1.0);
    const Eigen::MatrixXd before = ldlt.solve(A.mesh.V);
    countEigenvaluesBelow(other.W, other.D, 0.3, ldlt);
    EXPECT_EQ(ldlt.solve(A.mesh.V), before);
}

}  // namespace
}  // namespace spectral
