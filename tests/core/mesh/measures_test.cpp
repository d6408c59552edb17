#include "core/mesh/measures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "core/denoise/denoise.h"
#include "core/filter/fractional_filter.h"
#include "support/shapes.h"

namespace spectral {
namespace {

using testing::Mesh;

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

TEST(SignedVolume, IsZeroWherePartsCancel) {
    const Mesh ball = testing::icosphere(3);
    Mesh insideOut = ball;
    insideOut.V.rowwise() += Eigen::RowVector3d(3.1, 1.7, 2.3);
    insideOut.F.col(1).swap(insideOut.F.col(2));
    const Mesh both = testing::joined(ball, insideOut);
    EXPECT_GT(signedVolume(ball.V, ball.F), 4.0);
    EXPECT_EQ(signedVolume(both.V, both.F), 0.0);  // not -2e-15
}

TEST(SignedVolume, OfPartsFarApartIsTheSumOfTheirs) {
    const Mesh ball = testing::icosphere(3);
    Mesh far = ball;
    far.V.array() += 1 << 20;  // both balls have the same edges, up to 1e-10
    const Mesh both = testing::joined(ball, far);
    const double volume = signedVolume(ball.V, ball.F);
    EXPECT_NEAR(signedVolume(both.V, both.F), 2 * volume, 1e-6);
    EXPECT_NEAR(signedVolume(both.V, ball.F), volume, 1e-6);
}

TEST(EnclosesVolume, IsTrueForClosedSurfacesEvenFarFromTheOrigin) {
    testing::Mesh mesh = testing::torus(2, 0.7, 24, 12);
    EXPECT_TRUE(enclosesVolume(mesh.V, mesh.F));
    mesh.V.rowwise() += Eigen::RowVector3d(1e7, -2e7, 3e7);
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

TEST(EnclosesVolume, IsFalseForAnOpenTube) {
    testing::Mesh tube = testing::rectangle(2.0 * kPi, 3.0, 24, 12);
    for (Index i = 0; i < tube.V.rows(); ++i) {
        const double angle = tube.V(i, 0), height = tube.V(i, 1);
        tube.V.row(i) << std::cos(angle), std::sin(angle), height;
    }
    EXPECT_FALSE(enclosesVolume(tube.V, tube.F));
}

/// A terrain of cells of 30, with heights of up to 100, and some vertices without data.
Mesh terrain(const std::vector<Index>& lacking, double filler) {
    Mesh mesh = testing::rectangle(600, 600, 20, 20);
    for (Index i = 0; i < mesh.V.rows(); ++i)
        mesh.V(i, 2) = 50.0 + 50.0 * std::sin(0.01 * mesh.V(i, 0)) * std::cos(0.02 * mesh.V(i, 1));
    for (const Index i : lacking) mesh.V(i, 2) = filler;
    return mesh;
}

TEST(Measures, MissingDataDoNotChangeTheMeanEdge) {
    const double expected = [] {
        const Mesh mesh = terrain({}, 0.0);
        return meanEdgeLength(mesh.V, mesh.F);
    }();
    for (const double filler : {-9999.0, -32768.0, 1e5}) {
        const Mesh mesh = terrain({100, 101, 121, 122, 300}, filler);
        EXPECT_NEAR(meanEdgeLength(mesh.V, mesh.F), expected, 0.02 * expected);
        const MeshLengths::Filler found = lengthsOf(mesh.V, mesh.F).filler;
        EXPECT_EQ(found.vertices, 5);
        EXPECT_EQ(found.value, filler);
        EXPECT_EQ(found.axis, 2);
        EXPECT_EQ(found.isLowest, filler < 0.0);
    }
}

TEST(Measures, OneLowVertexAndAFlatBaseAreNoMissingData) {
    EXPECT_EQ(fillerOf(terrain({100}, -9999).V, terrain({}, 0).F).vertices, 0);
    EXPECT_EQ(fillerOf(terrain({}, 0).V, terrain({}, 0).F).vertices, 0);
    Mesh plane = terrain({}, 0);  // in single precision: no missing data, only round-off
    for (Index i = 0; i < plane.V.rows(); ++i)
        plane.V(i, 2) = i < 2 ? -5e-7 : 1e-8 * static_cast<double>(i % 9);
    EXPECT_EQ(fillerOf(plane.V, plane.F).vertices, 0);
    Mesh square{Vertices(4, 3), Faces(2, 3)};
    square.V << 0, 0, 0, 1, 1e-7, 0, 1, 1, 0, 0, 1, 0;
    square.F << 0, 1, 2, 0, 2, 3;
    EXPECT_EQ(fillerOf(square.V, square.F).vertices, 0);
    // A block: a plane below, and walls.
    Mesh block = testing::cube(4);
    for (Index i = 0; i < block.V.rows(); ++i)
        if (block.V(i, 2) == 1.0) block.V(i, 2) += 0.01 * std::sin(5.0 * block.V(i, 0));
    EXPECT_EQ(fillerOf(block.V, block.F).vertices, 0);
}

TEST(Surface, LeavesOutComponentsWithoutArea) {
    const Mesh sphere = testing::icosphere(3);
    Mesh debris{Vertices::Ones(3, 3), Faces(1, 3)};
    debris.F << 0, 1, 2;
    Mesh needle = debris;
    needle.V.row(1) *= 2.0;
    needle.V.row(2) *= 3.0;
    const Mesh both = testing::joined(testing::joined(debris, sphere), needle);
    FilterOptions options;
    options.featureSize = 0.5;
    options.tolerance = 1e-3;
    const FilterResult result = fractionalFilter(both.V, both.F, options);
    EXPECT_EQ(result.flatComponents, 2);
    EXPECT_EQ(result.components, 1);
    EXPECT_EQ(result.unreferencedVertices, 6);
    const FilterResult alone = fractionalFilter(sphere.V, sphere.F, options);
    EXPECT_TRUE(result.V.middleRows(3, sphere.V.rows()).isApprox(alone.V, 1e-9));
    EXPECT_EQ(result.V.topRows(3), debris.V);
    EXPECT_EQ(result.V.bottomRows(3), needle.V);
    EXPECT_EQ(denoise(both.V, both.F, DenoiseOptions{}).flatComponents, 2);
}

}  // namespace
}  // namespace spectral
