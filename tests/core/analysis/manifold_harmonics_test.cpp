#include "core/analysis/manifold_harmonics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/laplacian/laplacian.h"
#include "core/mesh/mesh.h"
#include "core/support/errors.h"
#include "support/evaluation.h"

namespace spectral {
namespace {

using testing::Mesh;

HarmonicsOptions ofSize(int k, LaplacianKind kind = LaplacianKind::IntrinsicDelaunay) {
    HarmonicsOptions options;
    options.basisSize = k;
    options.laplacian = kind;
    return options;
}

ManifoldHarmonics harmonicsOf(const Mesh& mesh, int k,
                              LaplacianKind kind = LaplacianKind::IntrinsicDelaunay) {
    return manifoldHarmonics(mesh.V, mesh.F, ofSize(k, kind));
}

TEST(ManifoldHarmonics, HaveTheSpheresEigenvaluesAndAreOrthonormal) {
    const Mesh sphere = testing::icosphere(4);
    const ManifoldHarmonics harmonics = harmonicsOf(sphere, 25);
    EXPECT_EQ(harmonics.lambda[0], 0.0);
    for (int l = 1; l <= 4; ++l)
        for (int i = l * l; i < (l + 1) * (l + 1); ++i)
            EXPECT_NEAR(harmonics.lambda[i] / (l * (l + 1.0)), 1.0, 0.01);
    const Eigen::VectorXd D = lumpedMass(sphere.V, sphere.F);
    EXPECT_LT(testing::orthonormalityError(harmonics.Phi, D), 1e-9);
}

TEST(ManifoldHarmonics, ReportTheSizeThatSplitsNoMultipleEigenvalue) {
    const Mesh sphere = testing::icosphere(3);
    const ManifoldHarmonics cut = harmonicsOf(sphere, 11);  // of 1 + 3 + 5 + 7
    EXPECT_EQ(cut.lambda.size(), 11);
    EXPECT_EQ(cut.wholeSize, 16);
    EXPECT_EQ(harmonicsOf(sphere, 9).wholeSize, 9);
}

TEST(ManifoldHarmonics, StartWithThePositiveConstantOfEveryComponent) {
    const ManifoldHarmonics harmonics =
        harmonicsOf(testing::joined(testing::icosphere(2), testing::icosphere(1)), 10);
    EXPECT_EQ(harmonics.lambda[0], 0.0);
    EXPECT_EQ(harmonics.lambda[1], 0.0);
    EXPECT_GT(harmonics.lambda[2], 0.0);
    EXPECT_GE(harmonics.Phi.leftCols(2).minCoeff(), 0.0);
}

TEST(ManifoldHarmonics, HaveTheSameSignsAfterAPermutationOfTheVertices) {
    const Mesh mesh = testing::blob();
    const Index n = mesh.V.rows();
    Mesh reversed = mesh;
    reversed.V = mesh.V.colwise().reverse();
    reversed.F = (n - 1 - mesh.F.array()).matrix();
    const ManifoldHarmonics expected = harmonicsOf(mesh, 50), permuted = harmonicsOf(reversed, 50);
    const Eigen::MatrixXd back = permuted.Phi.colwise().reverse();
    EXPECT_LT((back - expected.Phi).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(ManifoldHarmonics, AreZeroAtUnreferencedVertices) {
    const Mesh mesh = testing::blob();
    Vertices V(mesh.V.rows() + 1, 3);
    V << Eigen::RowVector3d(9, 9, 9), mesh.V;
    const Faces F = (mesh.F.array() + 1).matrix();
    const ManifoldHarmonics harmonics = manifoldHarmonics(V, F, ofSize(20));
    EXPECT_EQ(harmonics.Phi.rows(), V.rows());
    EXPECT_TRUE((harmonics.Phi.row(0).array() == 0.0).all());
}

TEST(ManifoldHarmonics, RejectASizeTooLargeForTheMesh) {
    const Mesh mesh = testing::icosphere(1);  // 42 vertices
    EXPECT_THROW(harmonicsOf(mesh, 42), InvalidOption);
    EXPECT_THROW(harmonicsOf(mesh, 1), InvalidOption);
    EXPECT_THROW(harmonicsOf(mesh, 0), InvalidOption);
    EXPECT_THROW(harmonicsOf(mesh, -3), InvalidOption);
    EXPECT_EQ(harmonicsOf(mesh, 41).lambda.size(), 41);
    EXPECT_THROW(harmonicsOf({Vertices(0, 3), Faces(0, 3)}, 10), InvalidMesh);
}

TEST(FixSigns, MakesTheExtremeEntryPositive) {
    Eigen::MatrixXd Phi(3, 2);
    Phi << 1.0, 0.5, -3.0, 2.0, 2.0, -1.0;
    fixSigns(Phi);
    EXPECT_EQ(Phi(1, 0), 3.0);
    EXPECT_EQ(Phi(0, 0), -1.0);
    EXPECT_EQ(Phi(1, 1), 2.0);
}

TEST(FixSigns, UsesTheFirstOfEntriesThatDifferOnlyByRoundOff) {
    for (const double noise : {1e-9, -1e-9}) {
        Eigen::MatrixXd Phi(4, 1);
        Phi << 0.1, -1.0, 1.0 + noise, 0.3;
        fixSigns(Phi);
        EXPECT_EQ(Phi(1, 0), 1.0) << noise;
    }
}

}  // namespace
}  // namespace spectral
