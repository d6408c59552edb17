#include "core/denoise/face_graph.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/mesh/measures.h"
#include "support/shapes.h"

namespace spectral {
namespace {

using testing::Mesh;

Index count(const std::vector<bool>& flags) { return std::count(flags.begin(), flags.end(), true); }

TEST(FaceGraph, OfAClosedSurfaceHasAnEdgeForEachOfTheMesh) {
    const Mesh torus = testing::torus(2.0, 0.5, 12, 8);
    const FaceGraph graph = faceGraph(torus.F, torus.V.rows());
    EXPECT_EQ(static_cast<Index>(graph.edges.size()), 3 * torus.F.rows() / 2);
    EXPECT_EQ(count(graph.onRim), 0);
    EXPECT_EQ(graph.F, torus.F) << "an oriented surface keeps its orientation";
    for (const FaceGraph::Edge& edge : graph.edges)
        for (const int face : edge.faces)
            for (const int end : edge.ends) EXPECT_TRUE((graph.F.row(face).array() == end).any());
}

TEST(FaceGraph, KnowsTheFacesAtEveryVertex) {
    const Mesh mesh = testing::blob();
    const FaceGraph graph = faceGraph(mesh.F, mesh.V.rows());
    EXPECT_EQ(graph.firstFace.back(), 3 * mesh.F.rows());
    for (Index i = 0; i < mesh.V.rows(); ++i)
        for (Index k = graph.firstFace[i]; k < graph.firstFace[i + 1]; ++k)
            EXPECT_TRUE((mesh.F.row(graph.faceAt[k]).array() == static_cast<int>(i)).any());
}

TEST(FaceGraph, OrientsNeighboursAlike) {
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
    EXPECT_TRUE(faceGraph(fins.F, 5).edges.empty()) << "three faces at one edge are no neighbours";
}

}  // namespace
}  // namespace spectral
