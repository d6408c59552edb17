#include "core/mesh/contacts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "core/denoise/denoise.h"
#include "core/filter/fractional_filter.h"
#include "core/mesh/measures.h"
#include "core/mesh/surface.h"
#include "support/noisy_shapes.h"

namespace spectral {
namespace {

using testing::Mesh;

/// Two cubes side by side, with noise that depends on the position alone.
Mesh touchingCubes() {
    Mesh right = testing::cube(8);
    right.V.col(0).array() += right.V.col(0).maxCoeff() - right.V.col(0).minCoeff();
    Mesh both = testing::joined(testing::cube(8), right);
    for (Index i = 0; i < both.V.rows(); ++i) {
        const Eigen::RowVector3d at = both.V.row(i);
        for (int c = 0; c < 3; ++c) both.V(i, c) += 0.02 * std::sin(41.0 * at.sum() + 7.0 * c);
    }
    return both;
}

/// Pairs of vertices at the same point.
std::vector<std::pair<Index, Index>> contactsOf(const Vertices& V) {
    std::vector<std::pair<Index, Index>> pairs;
    for (Index i = 0; i < V.rows(); ++i)
        for (Index j = i + 1; j < V.rows(); ++j)
            if (V.row(i) == V.row(j)) pairs.emplace_back(i, j);
    return pairs;
}

void expectAlike(const Mesh& mesh, const Vertices& moved) {
    const auto pairs = contactsOf(mesh.V);
    ASSERT_GE(pairs.size(), 49u);
    for (const auto& [i, j] : pairs) EXPECT_EQ(moved.row(i), moved.row(j));
    EXPECT_NE(moved, mesh.V);
}

TEST(Contacts, MoveAlikeWhenFiltered) {
    const Mesh mesh = touchingCubes();
    for (const bool preserveVolume : {false, true}) {
        FilterOptions options;
        options.featureSize = 0.15 * boundingBoxDiagonal(mesh.V);
        options.tolerance = 1e-3;
        options.preserveVolume = preserveVolume;
        const FilterResult result = fractionalFilter(mesh.V, mesh.F, options);
        EXPECT_EQ(result.components, 2);
        expectAlike(mesh, result.V);
    }
}

TEST(Contacts, AreNotWhereLevelsOfDetailLieOverOneAnother) {
    // Every fourth vertex of the finer sphere is one of the coarser: they have no edge in common.
    const Mesh fine = testing::icosphere(4), coarse = testing::icosphere(3);
    const Mesh both = testing::joined(fine, coarse);
    const Surface surface = joinedSurface(both.V, both.F);
    const Components components = connectedComponents(surface.F, surface.X.rows());
    ASSERT_GE(contactsOf(both.V).size(), 600u);
    Vertices displacement = Vertices::Random(surface.X.rows(), 3);
    const Vertices before = displacement;
    moveContactsAlike(surface, components, displacement);
    EXPECT_EQ(displacement, before);

    // The same faces twice.
    const Mesh over = testing::joined(fine, fine);
    const Surface twice = joinedSurface(over.V, over.F);
    const Components layers = connectedComponents(twice.F, twice.X.rows());
    displacement = Vertices::Random(twice.X.rows(), 3);
    const Vertices apart = displacement;
    moveContactsAlike(twice, layers, displacement);
    EXPECT_EQ(displacement, apart);
}

TEST(Parting, IsFoundWhereAComponentLeavesOneThatItTouched) {
    // An eye of 0.2 in a head of 1: half of it is outside.
    const Mesh head = testing::icosphere(4);
    Mesh eye = testing::icosphere(3);
    eye.V *= 0.2;
    eye.V.col(0).array() += 1.0;
    const Mesh both = testing::joined(head, eye);
    const double edge = meanEdgeLength(head.V, head.F);
    const auto partingAfter = [&](const Eigen::RowVector3d& eyeMoves) {
        Vertices moved = both.V;
        moved.bottomRows(eye.V.rows()).rowwise() += eyeMoves;
        return partingOf(both.V, both.F, moved, edge);
    };
    EXPECT_EQ(partingAfter({0.0, 0.0, 0.0}).components, 0);
    EXPECT_EQ(partingAfter({0.5 * edge, 0.0, 0.0}).components, 0);
    const Parting parting = partingAfter({0.4, 0.0, 0.0});
    EXPECT_EQ(parting.components, 1);
    EXPECT_EQ(parting.all, 2);
    EXPECT_LE(parting.distance, 0.4);
    EXPECT_GE(parting.distance, 0.4 - edge);
    EXPECT_EQ(partingOf(head.V, head.F, 2.0 * head.V, edge).components, 0);  // one component
    // Where the head leaves both eyes, these are counted: the smaller one of each pair.
    Mesh left = eye;
    left.V.col(0) *= -1.0;
    const Mesh face = testing::joined(both, left);
    Vertices moved = face.V;
    moved.topRows(head.V.rows()).col(2).array() += 0.4;
    EXPECT_EQ(partingOf(face.V, face.F, moved, edge).components, 2);
}

TEST(Contacts, MoveAlikeWhenDenoised) {
    const Mesh mesh = touchingCubes();
    DenoiseOptions options;
    options.noiseHeight = 0.02;
    expectAlike(mesh, denoise(mesh.V, mesh.F, options).V);
}

TEST(Contacts, StayWhereOneOfThemDoes) {
    const Mesh mesh = touchingCubes();
    const Surface surface = joinedSurface(mesh.V, mesh.F);
    const Components components = connectedComponents(surface.F, surface.X.rows());
    Vertices displacement = Vertices::Random(surface.X.rows(), 3);
    for (Index i = 0; i < displacement.rows(); ++i)
        if (components.label[i] == 0) displacement.row(i).setZero();
    const Vertices before = displacement;
    moveContactsAlike(surface, components, displacement);
    EXPECT_EQ(displacement, before);
}

TEST(Contacts, OfOneComponentAreLeftAlone) {
    const Mesh mesh = testing::cube(4);
    const Surface surface = joinedSurface(mesh.V, mesh.F);
    Vertices displacement = Vertices::Random(surface.X.rows(), 3);
    const Vertices before = displacement;
    moveContactsAlike(surface, connectedComponents(surface.F, surface.X.rows()), displacement);
    EXPECT_EQ(displacement, before);
}

}  // namespace
}  // namespace spectral
