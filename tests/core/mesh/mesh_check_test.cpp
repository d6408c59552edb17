#include "core/mesh/mesh_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "core/mesh/mesh.h"
#include "core/support/errors.h"
#include "support/shapes.h"

namespace spectral {
namespace {

using testing::Mesh;

std::string complaint(const Mesh& mesh, LaplacianKind kind = LaplacianKind::Cotangent) {
    try {
        checkMesh(mesh.V, mesh.F, kind);
    } catch (const InvalidMesh& error) {
        return error.what();
    }
    return "";
}

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

TEST(CheckMesh, AcceptsOpenClosedAndManyComponents) {
    for (const Mesh& mesh : {testing::blob(), testing::rectangle(1, 1, 2, 2),
                             testing::joined(testing::cube(2), testing::icosphere(1))})
        EXPECT_EQ(complaint(mesh), "");
}

TEST(CheckMesh, NamesAnEmptyMeshAndAPointCloud) {
    EXPECT_TRUE(contains(complaint({Vertices(0, 3), Faces(0, 3)}), "empty"));
    EXPECT_TRUE(contains(complaint({Vertices::Zero(5, 3), Faces(0, 3)}), "point cloud"));
}

TEST(CheckMesh, CountsCoordinatesThatAreNotFinite) {
    Mesh mesh = testing::blob();
    mesh.V(17, 1) = std::nan("");
    mesh.V(30, 2) = std::numeric_limits<double>::infinity();
    EXPECT_TRUE(contains(complaint(mesh), "2 vertices have coordinates that are not finite"));
    EXPECT_TRUE(contains(complaint(mesh), "vertex 17"));
}

TEST(CheckMesh, CountsTrianglesWithoutArea) {
    Mesh mesh = testing::blob();
    mesh.F.row(4) << 7, 7, 9;
    EXPECT_TRUE(contains(complaint(mesh), "1 triangle has no area"));
    EXPECT_TRUE(contains(complaint(mesh), "Remove Zero Area Faces"));
    EXPECT_EQ(complaint(mesh, LaplacianKind::IntrinsicDelaunay), "");
}

TEST(CheckMesh, RefusesAMeshWithoutAnyArea) {
    Mesh mesh = testing::icosphere(1);
    mesh.V.rightCols(2).setZero();
    EXPECT_TRUE(contains(complaint(mesh, LaplacianKind::IntrinsicDelaunay), "line or a point"));
}

TEST(CheckMesh, NamesAnIndexOutOfRange) {
    Mesh mesh = testing::icosphere(0);
    mesh.F(3, 1) = 12;
    EXPECT_TRUE(contains(complaint(mesh), "vertex 12"));
}

}  // namespace
}  // namespace spectral
