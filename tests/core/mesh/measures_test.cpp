#include "core/mesh/measures.h"

#include <gtest/gtest.h>

#include <utility>

#include "support/shapes.h"

namespace spectral {
namespace {

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
