#include "core/laplacian/laplacian.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/laplacian/constant_modes.h"
#include "core/laplacian/laplacian_builder.h"
#include "core/mesh/measures.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
#include "support/dense_eigenpairs.h"
#include "support/evaluation.h"
#include "support/shapes.h"

namespace spectral {
namespace {

using testing::Mesh;

Mesh rightTriangle() {
    // Legs 1 and 2, right angle at vertex 0: cotangents 0, 1/2 (at 1), 2 (at 2).
    Mesh mesh{Vertices(3, 3), Faces(1, 3)};
    mesh.V << 0, 0, 0, 1, 0, 0, 0, 2, 0;
    mesh.F << 0, 1, 2;
    return mesh;
}

TEST(CotangentLaplacian, OfARightTriangleMatchesTheHandComputation) {
    const Mesh mesh = rightTriangle();
    const Laplacian laplacian = testing::cotangentLaplacian(mesh.V, mesh.F);
    Eigen::Matrix3d expected;
    // w_01 = cot at 2 / 2 = 1, w_02 = cot at 1 / 2 = 1/4, w_12 = cot at 0 / 2 = 0.
    expected << 1.25, -1.0, -0.25, -1.0, 1.0, 0.0, -0.25, 0.0, 0.25;
    EXPECT_LT((Eigen::Matrix3d(laplacian.W) - expected).cwiseAbs().maxCoeff(), 1e-15);
    EXPECT_LT((laplacian.D.array() - 1.0 / 3.0).abs().maxCoeff(), 1e-15);
}

TEST(UniformLaplacian, EqualsTheCotangentOneOnCongruentEquilateralTriangles) {
    const Mesh mesh = testing::icosphere(0);
    const Laplacian uniform = meshLaplacian(mesh.V, mesh.F, LaplacianKind::Uniform).laplacian;
    const Laplacian cotangent = testing::cotangentLaplacian(mesh.V, mesh.F);
    EXPECT_LT(Eigen::MatrixXd(uniform.W - cotangent.W).cwiseAbs().maxCoeff(), 1e-14);
    EXPECT_LT((uniform.D - cotangent.D).cwiseAbs().maxCoeff(), 1e-14);
}

TEST(UniformLaplacian, DependsOnlyOnTheConnectivityAndTheArea) {
    Mesh mesh = testing::blob();
    const Laplacian before = meshLaplacian(mesh.V, mesh.F, LaplacianKind::Uniform).laplacian;
    mesh.V = testing::withNoise(mesh, 0.2, 1).V;
    const Laplacian after = meshLaplacian(mesh.V, mesh.F, LaplacianKind::Uniform).laplacian;
    EXPECT_EQ(Eigen::MatrixXd(before.W), Eigen::MatrixXd(after.W));
    EXPECT_NEAR(after.D.sum(), surfaceArea(mesh.V, mesh.F), 1e-12 * after.D.sum());
    EXPECT_EQ(after.D.minCoeff(), after.D.maxCoeff());
}

TEST(CotangentLaplacian, MassesSumToTheArea) {
    for (const Mesh& mesh : {testing::blob(), testing::rectangle(2, 3, 7, 5), testing::cube(4)}) {
        const Laplacian laplacian = testing::cotangentLaplacian(mesh.V, mesh.F);
        const double area = surfaceArea(mesh.V, mesh.F);
        EXPECT_NEAR(laplacian.D.sum(), area, 1e-12 * area);
        EXPECT_EQ(laplacian.D, lumpedMass(mesh.V, mesh.F));
    }
}

TEST(CotangentLaplacian, IsSymmetricPositiveSemidefiniteWithTheConstantsAsNullSpace) {
    for (const Mesh& mesh : {testing::blob(), testing::withNoise(testing::cube(4), 0.05, 1)}) {
        const Eigen::MatrixXd W = testing::cotangentLaplacian(mesh.V, mesh.F).W;
        EXPECT_EQ(W, W.transpose());
        EXPECT_LT(W.rowwise().sum().cwiseAbs().maxCoeff(), 1e-12 * W.cwiseAbs().maxCoeff());
        const Eigen::VectorXd lambda = testing::denseEigenvalues(W);
        EXPECT_GT(lambda[0], -1e-12 * lambda[lambda.size() - 1]);
        EXPECT_GT(lambda[1], 1e-6 * lambda[lambda.size() - 1]);
    }
}

TEST(CotangentLaplacian, OfLinearFunctionsVanishesInsideAPlane) {
    const Mesh mesh = testing::rectangle(1.0, 1.0, 6, 6);
    const Eigen::VectorXd residual = testing::cotangentLaplacian(mesh.V, mesh.F).W * mesh.V.col(0);
    for (Index i = 0; i < mesh.V.rows(); ++i)
        if (mesh.V(i, 0) > 0.01 && mesh.V(i, 0) < 0.99) {
            EXPECT_NEAR(residual[i], 0.0, 1e-14);
        }
}

TEST(IsUsable, IsFalseForCollapsedTriangles) {
    Mesh mesh = rightTriangle();
    EXPECT_TRUE(isUsable(testing::cotangentLaplacian(mesh.V, mesh.F)));
    mesh.V.row(2) << 2, 0, 0;  // all corners on a line
    EXPECT_FALSE(isUsable(testing::cotangentLaplacian(mesh.V, mesh.F)));
}

TEST(ConnectedComponents, AreLabelledInTheOrderOfTheirFirstVertex) {
    const Mesh one = testing::icosphere(0);
    const Mesh both = testing::joined(one, testing::rectangle(1, 1, 2, 2));
    const Components components = connectedComponents(both.F, both.V.rows());
    EXPECT_EQ(components.count, 2);
    EXPECT_TRUE((components.label->head(12).array() == 0).all());
    EXPECT_TRUE((components.label->tail(9).array() == 1).all());
}

TEST(ConstantModes, AreOrthonormalAndProjectedOut) {
    const Mesh mesh = testing::joined(testing::blob(), testing::icosphere(1));
    const Eigen::VectorXd D = lumpedMass(mesh.V, mesh.F);
    const ConstantModes constants(connectedComponents(mesh.F, mesh.V.rows()), D);
    const Eigen::MatrixXd modes = constants.orthonormal();
    EXPECT_LT(testing::orthonormalityError(modes, D), 1e-14);
    Eigen::MatrixXd X = mesh.V;
    constants.remove(D, X);
    EXPECT_LT(testing::innerProducts(modes, D, X).cwiseAbs().maxCoeff(), 1e-13);
    constants.add(constants.means(D, mesh.V), X);
    EXPECT_LT((X - mesh.V).cwiseAbs().maxCoeff(), 1e-15);
}

TEST(Measures, OfACubeMatchTheHandComputation) {
    const Mesh mesh = testing::cube(3);
    EXPECT_NEAR(surfaceArea(mesh.V, mesh.F), 24.0, 1e-12);
    EXPECT_NEAR(signedVolume(mesh.V, mesh.F), 8.0, 1e-12);
    EXPECT_NEAR(boundingBoxDiagonal(mesh.V), std::sqrt(12.0), 1e-15);
}

TEST(Measures, VolumeKeepsItsDigitsFarFromTheOrigin) {
    Mesh mesh = testing::cube(3);
    mesh.V.array() += 1e6;
    EXPECT_NEAR(signedVolume(mesh.V, mesh.F), 8.0, 1e-8);
}

}  // namespace
}  // namespace spectral
