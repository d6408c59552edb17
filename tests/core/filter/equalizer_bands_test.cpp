#include "core/filter/equalizer_bands.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "core/contract/filter.h"
#include "core/filter/fractional_filter.h"
#include "core/mesh/measures.h"
#include "core/support/memory.h"
#include "core/transfer/equalizer.h"
#include "support/shapes.h"

namespace spectral {
namespace {

using testing::Mesh;

constexpr double kSmallest = 0.25;
constexpr int kOctaves = 3;

BandOptions bandOptions() {
    BandOptions options;
    options.smallestSize = kSmallest;
    options.octaves = kOctaves;
    return options;
}

Vertices displacementOf(const Mesh& mesh, const BandOptions& options,
                        const std::vector<double>& gains) {
    const EqualizerBands bands(mesh.V, mesh.F, options, {});
    return changed(Vertices::Zero(mesh.V.rows(), 3), bands.surface(),
                   bands.displacement(octaveEqualizer(kSmallest, gains)));
}

/// The same by a filter of one step.
Vertices displacementInOneStep(const Mesh& mesh, const BandOptions& bands,
                               const std::vector<double>& gains) {
    const Equalizer equalizer = octaveEqualizer(kSmallest, gains);
    FilterOptions options;
    options.transferFunction.type = FilterType::Custom;
    options.transferFunction.custom = equalizer;
    options.featureSize = equalizer.middleSize();
    options.steps = 1;
    options.boundary = bands.boundary;
    options.part = bands.part;
    return fractionalFilter(mesh.V, mesh.F, options).V - mesh.V;
}

TEST(EqualizerBands, AddUpToTheFilterOfOneStep) {
    const Mesh meshes[] = {testing::withNoise(testing::icosphere(4), 0.02, 1),
                           testing::joined(testing::withNoise(testing::icosphere(3), 0.02, 2),
                                           testing::withNoise(testing::hemisphere(24), 0.02, 3))};
    for (const Mesh& mesh : meshes)
        for (const std::vector<double>& gains :
             {std::vector<double>{1, 1, 2}, {0, 1, 1}, {3, 0.5, 2}, {1.1, 1, 1}, {4, 0, 4}})
            for (const Boundary boundary : {Boundary::Free, Boundary::Fixed}) {
                BandOptions options = bandOptions();
                options.boundary = boundary;
                const Vertices expected = displacementInOneStep(mesh, options, gains);
                const Vertices found = displacementOf(mesh, options, gains);
                // A gain of 0 is a steep fall, which the bands round off.
                const bool isSteep = std::count(gains.begin(), gains.end(), 0.0) > 0;
                EXPECT_LT((found - expected).norm(), (isSteep ? 0.1 : 0.03) * expected.norm())
                    << gains[0] << ' ' << gains[1] << ' ' << gains[2];
            }
}

TEST(EqualizerBands, MoveNothingAtGainsOfOneAndNothingOnAFixedBoundary) {
    const Mesh mesh = testing::withNoise(testing::hemisphere(16), 0.02, 1);
    BandOptions options = bandOptions();
    EXPECT_EQ(displacementOf(mesh, options, {1, 1, 1}).cwiseAbs().maxCoeff(), 0.0);
    options.boundary = Boundary::Fixed;
    const Vertices moved = displacementOf(mesh, options, {2, 2, 2});
    const std::vector<bool> isBoundary = boundaryVertices(mesh.F, mesh.V.rows());
    for (Index i = 0; i < moved.rows(); ++i)
        if (isBoundary[i]) {
            EXPECT_EQ(moved.row(i).norm(), 0.0);
        }
    EXPECT_GT(moved.norm(), 0.0);
}

TEST(EqualizerBands, FadeOutAroundASelection) {
    const Mesh mesh = testing::withNoise(testing::icosphere(4), 0.02, 1);
    BandOptions options = bandOptions();
    for (Index i = 0; i < mesh.V.rows(); ++i) options.part.selected.push_back(mesh.V(i, 2) > 0.8);
    const Vertices expected = displacementInOneStep(mesh, options, {2, 2, 2});
    const Vertices found = displacementOf(mesh, options, {2, 2, 2});
    EXPECT_LT((found - expected).norm(), 0.03 * expected.norm());
    EXPECT_EQ(found.row(0).norm() > 0.0, expected.row(0).norm() > 0.0);
}

TEST(EqualizerPreview, KeepsItsBandsUntilWhatTheyDependOnChanges) {
    const Filter& filter = filterNamed("apply_coord_spectral_equalizer");
    Mesh mesh = testing::withNoise(testing::icosphere(3), 0.02, 1);
    const FilterInput input{mesh.V, mesh.F};
    std::shared_ptr<void> kept;
    const FilterOutput first = preview(filter, input, {{"gain_2x", 2.0}}, kept);
    const std::shared_ptr<void> bands = kept;
    ASSERT_NE(bands, nullptr);
    const FilterOutput second = preview(filter, input, {{"gain_2x", 0.5}}, kept);
    EXPECT_EQ(kept, bands);
    EXPECT_GT(testing::largestDifference(first.V, second.V), 0.0);
    preview(filter, input, {{"gain_2x", 2.0}, {"smallest_size", 0.3}}, kept);
    EXPECT_NE(kept, bands);
    mesh.V *= 2.0;
    const std::shared_ptr<void> others = kept;
    preview(filter, input, {{"gain_2x", 2.0}, {"smallest_size", 0.3}}, kept);
    EXPECT_NE(kept, others);
}

TEST(EqualizerPreview, WarnsLikeTheRunWhereAComponentLeavesOneThatItTouched) {
    Mesh head = testing::icosphere(4), eye = testing::icosphere(2);
    head.V.col(0) *= 1.5;
    eye.V *= 0.15;
    eye.V.col(0).array() += 1.5;
    const Mesh both = testing::joined(head, eye);
    const FilterInput input{both.V, both.F};
    const Filter& filter = filterNamed("apply_coord_spectral_equalizer");
    std::shared_ptr<void> kept;
    for (const double gain : {1.05, 3.0}) {
        const Values given{{"gain_32x", gain}, {"gain_16x", gain}};
        const std::size_t expected = gain > 2.0 ? 1 : 0;
        for (const FilterOutput& output :
             {apply(filter, input, given), preview(filter, input, given, kept)}) {
            ASSERT_EQ(output.warnings.size(), expected) << gain;
            for (const Warning& warning : output.warnings)
                EXPECT_EQ(warning.text.find("1 of 2 components moves up to"), 0u);
        }
    }
}

TEST(EqualizerPreview, IsTheRunItselfWhereMemoryIsShort) {
    const Filter& filter = filterNamed("apply_coord_spectral_equalizer");
    const Mesh mesh = testing::withNoise(testing::icosphere(3), 0.02, 1);
    const FilterInput input{mesh.V, mesh.F};
    const Values given{{"gain_2x", 2.0}};
    const FilterOutput expected = apply(filter, input, given);
    setMemoryMeasure([] { return 1e6; });
    std::shared_ptr<void> kept;
    const FilterOutput found = preview(filter, input, given, kept);
    setMemoryMeasure(nullptr);
    EXPECT_EQ(kept, nullptr);
    EXPECT_LT(testing::largestDifference(found.V, expected.V), 1e-6);
}

}  // namespace
}  // namespace spectral
