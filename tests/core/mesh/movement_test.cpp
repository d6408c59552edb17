#include "core/mesh/movement.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "support/shapes.h"

namespace spectral {
namespace {

/// A flat grid of cells of size 1, whose inner vertex at (2, 2) is number kInner.
testing::Mesh grid() { return testing::rectangle(4, 4, 4, 4); }

Index vertexAt(const testing::Mesh& mesh, double x, double y) {
    Index i = 0;
    (mesh.V.leftCols<2>().rowwise() - Eigen::RowVector2d(x, y)).rowwise().norm().minCoeff(&i);
    return i;
}

TEST(FoldedFaces, AreThoseThatAVertexTakesAcrossTheEdgesAroundIt) {
    const testing::Mesh mesh = grid();
    Vertices moved = mesh.V;
    moved.row(vertexAt(mesh, 2, 2)) += Eigen::RowVector3d(0.4, 0.3, 0.0);
    EXPECT_EQ(foldedFaces(mesh.V, moved, mesh.F), 0);
    // Its six faces at most, of which those ahead of it turn over.
    moved.row(vertexAt(mesh, 2, 2)) += Eigen::RowVector3d(1.0, 0.0, 0.0);
    Index turned = 0;
    for (Index t = 0; t < mesh.F.rows(); ++t) {
        const Eigen::RowVector3d a = moved.row(mesh.F(t, 0)), b = moved.row(mesh.F(t, 1)),
                                 c = moved.row(mesh.F(t, 2));
        turned += (b - a).cross(c - a)[2] < 0.0;
    }
    EXPECT_GT(turned, 0);
    EXPECT_EQ(foldedFaces(mesh.V, moved, mesh.F), turned);
}

TEST(FoldedFaces, AreNoneWhereTheSurfaceTurnsAsAWhole) {
    const testing::Mesh mesh = testing::blob();
    const Vertices turned =
        mesh.V * Eigen::AngleAxisd(3.0, Eigen::Vector3d(1, 2, 2) / 3.0).toRotationMatrix();
    EXPECT_EQ(foldedFaces(mesh.V, turned, mesh.F), 0);
}

TEST(FoldedFaces, AreNotThoseThatAreTooSmallToBeSeen) {
    // The faces between two close vertices, one of which passes the other.
    testing::Mesh mesh = grid();
    const Index corner = vertexAt(mesh, 2, 2), next = vertexAt(mesh, 3, 2);
    for (const double size : {0.3, 0.001}) {
        Vertices V(mesh.V), moved;
        V.row(next) = V.row(corner) + Eigen::RowVector3d(size, 0, 0);
        moved = V;
        moved.row(next) = V.row(corner) - Eigen::RowVector3d(size, 0, 0);
        EXPECT_EQ(foldedFaces(V, moved, mesh.F) > 0, size > 0.01) << size;
    }
}

}  // namespace
}  // namespace spectral
