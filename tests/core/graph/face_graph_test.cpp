#include "core/graph/face_graph.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/mesh/measures.h"
#include "support/shapes.h"

namespace spectral {
namespace {

using testing::Mesh;

Index count(const std::vector<bool>& flags) { return std::count(flags.begin(), flags.end(), true); }

TEST(FaceGraph, HasThreeNeighboursPerFaceOnAClosedSurface) {
    const Mesh torus = testing::torus(2.0, 0.5, 12, 8);
    const FaceGraph graph = faceGraph(torus.F, torus.V.rows());
    EXPECT_EQ(count(graph.onRim), 0);
    EXPECT_EQ(graph.F, torus.F) << "an oriented surface keeps its orientation";
    for (Index f = 0; f < graph.faceCount(); ++f)
        for (int c = 0; c < 3; ++c) {
            const int other = graph.neighbours(f, c);
            ASSERT_GE(other, 0);
            for (const int shared : {graph.F(f, (c + 1) % 3), graph.F(f, (c + 2) % 3)})
                EXPECT_TRUE((graph.F.row(other).array() == shared).any());
            EXPECT_FALSE((graph.F.row(other).array() == graph.F(f, c)).any());
        }
}

TEST(FaceGraph, ListsTheFacesAndNeighboursOfEveryVertex) {
    const Mesh mesh = testing::blob();
    const FaceGraph graph = faceGraph(mesh.F, mesh.V.rows());
    EXPECT_EQ(graph.faces.first.back(), 3 * mesh.F.rows());
    EXPECT_EQ(graph.vertices.first.back(), 3 * mesh.F.rows()) << "two ends of 3 m / 2 edges";
    for (Index i = 0; i < mesh.V.rows(); ++i) {
        EXPECT_EQ(graph.faces.degree(i), graph.vertices.degree(i)) << "closed";
        for (Index k = graph.faces.first[i]; k < graph.faces.first[i + 1]; ++k)
            EXPECT_TRUE((mesh.F.row(graph.faces.at[k]).array() == static_cast<int>(i)).any());
        for (Index k = graph.vertices.first[i] + 1; k < graph.vertices.first[i + 1]; ++k)
            EXPECT_LT(graph.vertices.at[k - 1], graph.vertices.at[k]);
    }
}

TEST(FaceGraph, OrientsFacesConsistently) {
    Mesh mesh = testing::joined(testing::blob(), testing::cube(4));
    const double volume = std::abs(signedVolume(mesh.V, mesh.F));
    for (Index t = 1; t < mesh.F.rows(); t += 3) std::swap(mesh.F(t, 0), mesh.F(t, 1));
    ASSERT_LT(std::abs(signedVolume(mesh.V, mesh.F)), 0.9 * volume);
    const FaceGraph graph = faceGraph(mesh.F, mesh.V.rows());
    EXPECT_NEAR(std::abs(signedVolume(mesh.V, graph.F)), volume, 1e-12 * volume);
}

TEST(FaceGraph, HasARimAtABoundaryAndWhereThreeFacesMeet) {
    const Mesh plane = testing::rectangle(3, 2, 6, 4);
    EXPECT_EQ(count(faceGraph(plane.F, plane.V.rows()).onRim), 2 * (6 + 4));

    Mesh fins = testing::rectangle(1, 1, 1, 1);
    fins.V.conservativeResize(5, 3);
    fins.V.row(4) << 0.5, 0.5, 1.0;
    const int a = fins.F(0, 0);
    int b = -1;  // the other end of the diagonal
    for (int c = 0; c < 3; ++c)
        if (fins.F(0, c) != a && (fins.F.row(1).array() == fins.F(0, c)).any()) b = fins.F(0, c);
    fins.F.conservativeResize(3, 3);
    fins.F.row(2) << a, b, 4;
    EXPECT_EQ(faceGraph(fins.F, 5).neighbours, Faces::Constant(3, 3, -1))
        << "three faces at one edge are not neighbours";
}

TEST(FaceGraph, CountsFacesWithTheSameCornersOnce) {
    const Mesh torus = testing::torus(2.0, 0.5, 12, 8);
    EXPECT_EQ(distinctFaces(torus.F, torus.V.rows()), torus.F);
    Faces twice(2 * torus.F.rows(), 3);
    twice << torus.F, torus.F.rowwise().reverse();
    EXPECT_EQ(distinctFaces(twice, torus.V.rows()), torus.F);
}

}  // namespace
}  // namespace spectral
