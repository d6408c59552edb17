/// What is filtered, and how much of it: selections, weights, creases, volumes.

#include <gtest/gtest.h>

#include <cmath>

#include "core/filter/fractional_filter.h"
#include "core/laplacian/vertex_weight.h"
#include "core/mesh/creases.h"
#include "core/mesh/measures.h"
#include "core/support/errors.h"
#include "support/evaluation.h"

namespace spectral {
namespace {

using testing::Mesh;
using testing::Operator;

FilterOptions smoothing(const Mesh& mesh) {
    FilterOptions options;
    options.featureSize = 0.2 * boundingBoxDiagonal(mesh.V);
    options.steps = 2;
    return options;
}

std::vector<bool> above(const Mesh& mesh, double height) {
    std::vector<bool> selected;
    for (Index i = 0; i < mesh.V.rows(); ++i) selected.push_back(mesh.V(i, 2) > height);
    return selected;
}

/// Many noisy spheres of different sizes in a row.
Mesh bubbles(int count) {
    Mesh all = testing::withNoise(testing::icosphere(2), 0.03, 1);
    for (int k = 1; k < count; ++k) {
        Mesh one = testing::withNoise(testing::icosphere(1), 0.05, static_cast<unsigned>(k));
        one.V = one.V * (0.2 + 0.01 * k);
        one.V.col(0).array() += 3.0 * k;
        all = testing::joined(all, one);
    }
    return all;
}

TEST(SelectionWeight, FallsFromOneToExactlyZeroWithinTheWidth) {
    const double width = 0.5;
    const Operator plane(testing::rectangle(4, 1, 80, 20));
    std::vector<bool> selected;
    for (Index i = 0; i < plane.mesh.V.rows(); ++i) selected.push_back(plane.mesh.V(i, 0) < 1.0);
    const Components whole = connectedComponents(plane.mesh.F, plane.mesh.V.rows());
    const Eigen::VectorXd weight = selectionWeight(plane, whole, selected, width);
    for (Index i = 0; i < weight.size(); ++i) {
        const double distance = plane.mesh.V(i, 0) - 0.95;  // from the last selected column
        if (distance < 0.01) {
            EXPECT_EQ(weight[i], 1.0);
        } else if (distance > 1.05 * width) {
            EXPECT_EQ(weight[i], 0.0);
        } else {
            // On a plane m is exp(-3 distance / width), and the weight its smooth step.
            const double last = std::exp(-3.0), m = std::exp(-3.0 * distance / width);
            const double t = std::max(0.0, (m - last) / (1.0 - last));
            EXPECT_NEAR(weight[i], t * t * (3.0 - 2.0 * t), 0.01);
        }
    }
}

TEST(PartOfMesh, SelectionIsFilteredAsInTheWholeAndDistantVerticesStayBitIdentical) {
    const Mesh mesh = testing::withNoise(testing::icosphere(4), 0.01, 2);
    FilterOptions options = smoothing(mesh);
    const Vertices whole = fractionalFilter(mesh.V, mesh.F, options).V;
    options.part.selected = above(mesh, 0.5);
    const Vertices part = fractionalFilter(mesh.V, mesh.F, options).V;
    int blended = 0;
    for (Index i = 0; i < mesh.V.rows(); ++i) {
        if (mesh.V(i, 2) > 0.5) {
            EXPECT_LT((part.row(i) - whole.row(i)).norm(), 1e-14);
        } else if (mesh.V(i, 2) < 0.5 - options.featureSize) {
            EXPECT_EQ(part.row(i), mesh.V.row(i));
        } else {
            blended += part.row(i) != mesh.V.row(i) && part.row(i) != whole.row(i);
        }
    }
    EXPECT_GT(blended, 100);
}

TEST(PartOfMesh, SelectingEverythingIsBitIdenticalToNoSelection) {
    const Mesh mesh = testing::blob();
    FilterOptions options = smoothing(mesh);
    const Vertices whole = fractionalFilter(mesh.V, mesh.F, options).V;
    options.part.selected.assign(static_cast<std::size_t>(mesh.V.rows()), true);
    EXPECT_EQ(fractionalFilter(mesh.V, mesh.F, options).V, whole);
}

TEST(PartOfMesh, OnlyASelectedComponentIsFiltered) {
    const Mesh mesh =
        testing::joined(testing::blob(), testing::withNoise(testing::cube(5), 0.02, 3));
    const Index first = testing::blob().V.rows();
    FilterOptions options = smoothing(mesh);
    const Vertices whole = fractionalFilter(mesh.V, mesh.F, options).V;
    for (Index i = 0; i < mesh.V.rows(); ++i) options.part.selected.push_back(i < first);
    const Vertices part = fractionalFilter(mesh.V, mesh.F, options).V;
    EXPECT_EQ(part.topRows(first), whole.topRows(first));
    EXPECT_EQ(part.bottomRows(mesh.V.rows() - first), mesh.V.bottomRows(mesh.V.rows() - first));
}

TEST(PartOfMesh, AnEmptySelectionIsRefused) {
    const Mesh mesh = testing::blob();
    FilterOptions options = smoothing(mesh);
    options.part.selected.assign(static_cast<std::size_t>(mesh.V.rows()), false);
    EXPECT_THROW(fractionalFilter(mesh.V, mesh.F, options), InvalidOption);
}

TEST(PartOfMesh, WeightsScaleTheDisplacementOfEachVertex) {
    const Mesh mesh = testing::blob();
    FilterOptions options = smoothing(mesh);
    const Vertices whole = fractionalFilter(mesh.V, mesh.F, options).V;
    options.part.weight = Eigen::VectorXd::LinSpaced(mesh.V.rows(), 0.0, 1.0);
    const Vertices part = fractionalFilter(mesh.V, mesh.F, options).V;
    EXPECT_EQ(part.row(0), mesh.V.row(0));
    EXPECT_EQ(part.bottomRows(1), whole.bottomRows(1));
    const Vertices expected = mesh.V + options.part.weight.asDiagonal() * (whole - mesh.V);
    EXPECT_LT((part - expected).cwiseAbs().maxCoeff(), 1e-14);

    for (const double wrong : {-0.1, 1.1, std::nan("")}) {
        options.part.weight[7] = wrong;
        EXPECT_THROW(fractionalFilter(mesh.V, mesh.F, options), InvalidOption);
    }
}

TEST(PartOfMesh, EveryClosedComponentKeepsItsVolume) {
    const Mesh mesh = testing::joined(bubbles(45), testing::hemisphere(6));
    FilterOptions options = smoothing(mesh);
    options.featureSize = 0.4;
    options.preserveVolume = true;
    const FilterResult result = fractionalFilter(mesh.V, mesh.F, options);
    EXPECT_EQ(result.volumes.preserved, 45);
    EXPECT_EQ(result.volumes.open, 1);
    EXPECT_EQ(result.volumes.lost, 0);
    const Components components = connectedComponents(mesh.F, mesh.V.rows());
    for (int c = 0; c < 45; ++c) {
        std::vector<int> faces;
        for (int t = 0; t < mesh.F.rows(); ++t)
            if (components.label[mesh.F(t, 0)] == c) faces.push_back(t);
        const Faces F = mesh.F(faces, Eigen::indexing::all);
        const double before = signedVolume(mesh.V, F);
        EXPECT_NEAR(signedVolume(result.V, F), before, 1e-9 * std::abs(before)) << c;
    }
    options.preserveVolume = false;
    const Vertices shrunk = fractionalFilter(mesh.V, mesh.F, options).V;
    EXPECT_LT(signedVolume(shrunk, mesh.F), 0.99 * signedVolume(mesh.V, mesh.F));
}

TEST(PartOfMesh, ComponentsFarApartKeepTheirVolumes) {
    const Mesh ball = testing::withNoise(testing::icosphere(3), 0.01, 1);
    Mesh far = ball;
    far.V.array() += 1e5;
    const Mesh mesh = testing::joined(ball, far);
    FilterOptions options = smoothing(mesh);
    options.featureSize = 0.4;
    options.preserveVolume = true;
    const FilterResult result = fractionalFilter(mesh.V, mesh.F, options);
    EXPECT_EQ(result.volumes.preserved, 2);
    const Vertices first = result.V.topRows(ball.V.rows());
    EXPECT_NEAR(signedVolume(first, ball.F), signedVolume(ball.V, ball.F), 1e-6);
}

TEST(PartOfMesh, AnInsideOutComponentKeepsItsVolumeToo) {
    Mesh mesh = testing::withNoise(testing::icosphere(2), 0.03, 1);
    mesh.F.col(0).swap(mesh.F.col(1));
    FilterOptions options = smoothing(mesh);
    options.preserveVolume = true;
    const FilterResult result = fractionalFilter(mesh.V, mesh.F, options);
    EXPECT_EQ(result.volumes.preserved, 1);
    EXPECT_NEAR(result.volumeAfter, result.volumeBefore, 1e-9 * std::abs(result.volumeBefore));
}

TEST(PartOfMesh, PreservingTheVolumeMovesNothingFarFromTheSelection) {
    const Mesh mesh = testing::withNoise(testing::icosphere(4), 0.01, 2);
    FilterOptions options = smoothing(mesh);
    options.part.selected = above(mesh, 0.5);
    options.preserveVolume = true;
    const FilterResult result = fractionalFilter(mesh.V, mesh.F, options);
    EXPECT_NEAR(result.volumeAfter, result.volumeBefore, 1e-9 * result.volumeBefore);
    for (Index i = 0; i < mesh.V.rows(); ++i)
        if (mesh.V(i, 2) < 0.5 - options.featureSize) {
            EXPECT_EQ(result.V.row(i), mesh.V.row(i));
        }
}

TEST(PartOfMesh, CreasesStayAndFacesAreFiltered) {
    const Mesh clean = testing::cube(8);
    Mesh noisy = clean;  // only inside the faces
    const std::vector<bool> onCrease = creaseVertices(clean.V, clean.F, 40.0);
    const Vertices noise = testing::withNoise(clean, 0.03, 5).V - clean.V;
    for (Index i = 0; i < clean.V.rows(); ++i)
        if (!onCrease[i]) noisy.V.row(i) += noise.row(i);
    FilterOptions options = smoothing(noisy);
    options.featureSize = 1.5;  // six edges
    // From the planes: a filter keeps noise within a plane.
    const auto distance = [](const Vertices& V) {
        return (V.rowwise().lpNorm<Eigen::Infinity>().array() - 1.0).matrix().norm();
    };
    const double rounded = distance(fractionalFilter(noisy.V, noisy.F, options).V);
    options.creaseAngle = 60.0;
    const FilterResult result = fractionalFilter(noisy.V, noisy.F, options);
    EXPECT_EQ(result.fixedVertices, 8 + 12 * 7);
    for (Index i = 0; i < clean.V.rows(); ++i)
        if (onCrease[i]) {
            EXPECT_EQ(result.V.row(i), clean.V.row(i));
        }
    EXPECT_LT(distance(result.V), 0.5 * distance(noisy.V));
    EXPECT_LT(distance(result.V), 0.2 * rounded);
    options.creaseAngle = 181.0;
    EXPECT_THROW(fractionalFilter(noisy.V, noisy.F, options), InvalidOption);
}

}  // namespace
}  // namespace spectral
