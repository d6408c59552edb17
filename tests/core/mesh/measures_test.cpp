#include "core/mesh/measures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "support/shapes.h"

namespace spectral {
namespace {

TEST(MeshLengths, AreBitForBitTheSameIfTrianglesUseEveryVertex) {
    const testing::Mesh mesh = testing::torus(2, 0.7, 24, 12);
    const MeshLengths lengths = lengthsOf(mesh.V, mesh.F);
    EXPECT_EQ(lengths.diagonal, boundingBoxDiagonal(mesh.V));
    EXPECT_EQ(lengths.surfaceDiagonal, lengths.diagonal);
    EXPECT_EQ(lengths.outside, 0);
}

TEST(MeshLengths, TellVerticesOfTrianglesFromOthers) {
    Vertices V(6, 3);
    V << 0, 0, 0, 3, 0, 0, 0, 4, 0, 1, 1, 0, 0, 0, 12, NAN, 0, 0;
    Faces F(1, 3);
    F << 0, 1, 2;
    const MeshLengths lengths = lengthsOf(V, F);
    EXPECT_EQ(lengths.diagonal, 13.0);
    EXPECT_EQ(lengths.surfaceDiagonal, 5.0);
    EXPECT_EQ(lengths.outside, 1);
    EXPECT_EQ(lengths.meanEdge, 4.0);
    EXPECT_EQ(lengthsOf(V, Faces(0, 3)).surfaceDiagonal, 13.0);
    EXPECT_EQ(lengthsOf(Vertices(0, 3), Faces(0, 3)).diagonal, 0.0);
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
