#include "core/mesh/creases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/support/types.h"
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

/// Sheets of quadrilaterals that meet in the z axis, each in a direction across it, in degrees.
Mesh sheets(const std::vector<double>& directions, int cells) {
    Mesh mesh = testing::rectangle(cells, cells, cells, cells);
    const Mesh sheet = mesh;
    const Index n = sheet.V.rows(), m = sheet.F.rows(), k = static_cast<Index>(directions.size());
    mesh.V.resize(k * n, 3);
    mesh.F.resize(k * m, 3);
    const double left = sheet.V.col(0).minCoeff();
    for (Index s = 0; s < k; ++s) {
        const double angle = directions[static_cast<std::size_t>(s)] * kPi / 180.0;
        const auto along = (sheet.V.col(0).array() - left).matrix();
        mesh.V.middleRows(s * n, n) << std::cos(angle) * along, std::sin(angle) * along,
            sheet.V.col(1);
        mesh.F.middleRows(s * m, m) = sheet.F.array() + static_cast<int>(s * n);
    }
    const auto first = [&](int i) {  // of the sheets' vertices at a point
        for (int j = 0; j < i; ++j)
            if ((mesh.V.row(j) - mesh.V.row(i)).norm() < 1e-9) return j;
        return i;
    };
    mesh.F = mesh.F.unaryExpr(first).eval();
    return mesh;
}

TEST(Creases, AreWhereAnyTwoOfSeveralSheetsFold) {
    const int cells = 4;
    const auto crease = [&](const std::vector<double>& directions) {
        const Mesh mesh = sheets(directions, cells);
        return count(creaseVertices(mesh.V, mesh.F, 40.0));
    };
    EXPECT_EQ(crease({0, 180}), 0);
    EXPECT_EQ(crease({0, 120}), cells + 1);
    EXPECT_EQ(crease({0, 180, 90}), cells + 1);
    EXPECT_EQ(crease({0, 120, 240}), cells + 1);
    EXPECT_EQ(crease({0, 180, 90, 270}), cells + 1);
}

TEST(Creases, AreNotWhereASheetHasTwoSides) {
    Mesh mesh = sheets({0, 170}, 4);
    const Index m = mesh.F.rows();
    Faces F(2 * m, 3);
    F.topRows(m) = mesh.F;
    F.bottomRows(m).col(0) = mesh.F.col(1);
    F.bottomRows(m).col(1) = mesh.F.col(0);
    F.bottomRows(m).col(2) = mesh.F.col(2);
    EXPECT_EQ(count(creaseVertices(mesh.V, F, 40.0)), 24);  // the rim, where the sides meet
}

/// Vertices along sharp edges that move by a distance, among 99 others that move by 1.
RoundedCreases roundedBy(double distance, Index count) {
    std::vector<bool> along(static_cast<std::size_t>(count + 99), false);
    std::fill_n(along.begin(), count, true);
    Vertices displacement = Vertices::Zero(count + 99, 3);
    displacement.col(1).setOnes();
    displacement.col(1).head(count).setConstant(distance);
    return roundedCreases(along, displacement);
}

TEST(RoundedCreases, AreThoseThatMovedThirtyTimesAsFarAsTheRest) {
    EXPECT_EQ(roundedBy(29.9, 10).vertices, 0);
    EXPECT_EQ(roundedBy(30.1, 10).vertices, 10);
    EXPECT_DOUBLE_EQ(roundedBy(30.1, 10).largest, 30.1);
    EXPECT_EQ(roundedBy(30.1, 9).vertices, 0);  // too few to be the edges of a part
    // Half of the rest decides, however far the others move.
    std::vector<bool> along(60, false);
    std::fill_n(along.begin(), 20, true);
    Vertices displacement = Vertices::Zero(60, 3);
    displacement.col(0).head(20).setConstant(40.0);
    displacement.col(0).segment(20, 21).setOnes();
    displacement.col(0).tail(19).setConstant(1000.0);
    EXPECT_EQ(roundedCreases(along, displacement).vertices, 20);
}

}  // namespace
}  // namespace spectral
