#include "core/mesh/creases.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/shapes.h"

namespace spectral {
namespace {

using testing::Mesh;

Index count(const std::vector<bool>& flags) { return std::count(flags.begin(), flags.end(), true); }

TEST(Creases, AreTheTwelveEdgesOfACube) {
    const int cells = 5;
    const Mesh cube = testing::cube(cells);
    const Index edges = 8 + 12 * (cells - 1);
    EXPECT_EQ(count(creaseVertices(cube.V, cube.F, 1.0)), edges);
    EXPECT_EQ(count(creaseVertices(cube.V, cube.F, 89.9)), edges);
    EXPECT_EQ(count(creaseVertices(cube.V, cube.F, 90.1)), 0);
    const std::vector<bool> onCrease = creaseVertices(cube.V, cube.F, 40.0);
    for (Index i = 0; i < cube.V.rows(); ++i)
        EXPECT_EQ(onCrease[i], (cube.V.row(i).cwiseAbs().array() > 0.999).count() >= 2) << i;
}

TEST(Creases, DoNotDependOnOrientation) {
    Mesh cube = testing::cube(3);
    const std::vector<bool> expected = creaseVertices(cube.V, cube.F, 40.0);
    for (Index t = 0; t < cube.F.rows(); t += 3) std::swap(cube.F(t, 0), cube.F(t, 1));
    EXPECT_EQ(creaseVertices(cube.V, cube.F, 40.0), expected);
}

TEST(Creases, AreAbsentInAPlaneAndAtABoundary) {
    const Mesh plane = testing::rectangle(2, 1, 8, 4);
    EXPECT_EQ(count(creaseVertices(plane.V, plane.F, 1e-3)), 0);
}

TEST(Creases, IncludeAFoldedEdge) {
    Vertices V(4, 3);
    V << 0, 0, 0, 1, 0, 0, 0.5, 1, 0, 0.5, 1, 1e-9;
    Faces F(2, 3);
    F << 0, 1, 2, 1, 0, 3;
    EXPECT_EQ(count(creaseVertices(V, F, 179.0)), 2);
}

}  // namespace
}  // namespace spectral
