#include "core/mesh/measures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "support/shapes.h"

namespace spectral {
namespace {

TEST(Diagonals, AreTheSameToTheBitIfTrianglesUseEveryVertex) {
    const testing::Mesh mesh = testing::torus(2, 0.7, 24, 12);
    const Diagonals diagonals = diagonalsOf(mesh.V, mesh.F);
    EXPECT_EQ(diagonals.all, boundingBoxDiagonal(mesh.V));
    EXPECT_EQ(diagonals.surface, diagonals.all);
    EXPECT_EQ(diagonals.outside, 0);
}

TEST(Diagonals, TellVerticesOfTrianglesFromOthers) {
    Vertices V(6, 3);
    V << 0, 0, 0, 3, 0, 0, 0, 4, 0, 1, 1, 0, 0, 0, 12, NAN, 0, 0;
    Faces F(1, 3);
    F << 0, 1, 2;
    const Diagonals diagonals = diagonalsOf(V, F);
    EXPECT_EQ(diagonals.all, 13.0);
    EXPECT_EQ(diagonals.surface, 5.0);
    EXPECT_EQ(diagonals.outside, 1);
    EXPECT_EQ(diagonalsOf(V, Faces(0, 3)).surface, 13.0);
    EXPECT_EQ(diagonalsOf(Vertices(0, 3), Faces(0, 3)).all, 0.0);
}

TEST(EnclosesVolume, IsTrueForClosedSurfacesEvenFarFromTheOrigin) {
    testing::Mesh mesh = testing::torus(2, 0.7, 24, 12);
    EXPECT_TRUE(enclosesVolume(mesh.V, mesh.F));
    mesh.V.rowwise() += Eigen::RowVector3d(1e5, -2e5, 3e5);
    EXPECT_TRUE(enclosesVolume(mesh.V, mesh.F));
}

TEST(EnclosesVolume, IsFalseForOpenSurfacesAndFlippedTriangles) {
    const testing::Mesh rectangle = testing::rectangle(2, 1, 8, 4);
    EXPECT_FALSE(enclosesVolume(rectangle.V, rectangle.F));
    testing::Mesh sphere = testing::icosphere(2);
    EXPECT_FALSE(enclosesVolume(sphere.V, sphere.F.topRows(sphere.F.rows() - 1)));
    std::swap(sphere.F(0, 1), sphere.F(0, 2));
    EXPECT_FALSE(enclosesVolume(sphere.V, sphere.F));
}

}  // namespace
}  // namespace spectral
