#include "core/analysis/geometry_spectrum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/analysis/bands.h"
#include "core/mesh/measures.h"
#include "core/mesh/mesh.h"
#include "support/geometry_spectra.h"
#include "support/shapes.h"

namespace spectral {
namespace {

using testing::Mesh;
using testing::spectrumOf;
using testing::withBasis;

std::vector<Mesh> classesOfMeshes() {
    return {testing::blob(), testing::withNoise(testing::rectangle(2, 1, 32, 16), 0.01, 3),
            testing::joined(testing::withNoise(testing::icosphere(2), 0.05, 5),
                            testing::torus(2, 0.7, 16, 8)),
            testing::withNoise(testing::icosphere(3), 0.005, 4)};
}

TEST(GeometrySpectrum, IsOneFrequencyForASphere) {
    Mesh sphere = testing::icosphere(4);
    sphere.V *= 3.0;
    const GeometrySpectrum spectrum = spectrumOf(sphere, 20);
    const double featureSize = 2.0 * kPi / std::sqrt(2.0 / 9.0);  // lambda = l (l + 1) / r^2
    EXPECT_NEAR(spectrum.featureSize50 / featureSize, 1.0, 2e-3);
    EXPECT_NEAR(spectrum.featureSize99 / featureSize, 1.0, 2e-3);
    EXPECT_NEAR(spectrum.octaveAmplitudes[0], 3.0, 0.02);  // the radius
    EXPECT_LT(spectrum.octaveAmplitudes.tail(spectrum.octaveAmplitudes.size() - 1).maxCoeff(),
              1e-3);
    EXPECT_EQ(spectrum.amplitudes[0], 0.0);
    EXPECT_EQ(spectrum.frequencies[0], 0.0);
}

/// Octave whose centre is nearest to a feature size.
Index octaveOf(const GeometrySpectrum& spectrum, double featureSize) {
    Index j = 0;
    (spectrum.octaveFeatureSizes.array().log() - std::log(featureSize)).abs().minCoeff(&j);
    return j;
}

TEST(GeometrySpectrum, ShowsAWaveOnARectangleInItsOctaveWithItsAmplitude) {
    // Height e cos(p pi x / a) on a rectangle a x b: its root mean square is e / sqrt(2), its
    // wavelength 2 a / p. The plane itself has the waves of x and y, x = a/2 - 4 a / pi^2 sum over
    // odd m of cos(m pi x / a) / m^2.
    const double a = 2.0, b = 1.0, e = 0.004;
    const int p = 14;
    const double featureSize = 2.0 * a / p;
    Mesh mesh = testing::rectangle(a, b, 128, 64);
    for (Index i = 0; i < mesh.V.rows(); ++i)
        mesh.V(i, 2) = e * std::cos(p * kPi * mesh.V(i, 0) / a);
    const double diagonal = boundingBoxDiagonal(mesh.V);
    for (const int basisSize : {10, 400}) {  // the wave is beyond the basis, or in it
        const GeometrySpectrum spectrum = spectrumOf(mesh, basisSize);
        const Index j = octaveOf(spectrum, featureSize);
        const Bands octaves(diagonal, spectrum.frequencies[1], 1e3);
        double squares = 0.5 * e * e;
        for (const double side : {a, b})
            for (int m = 1; m < 100; m += 2)
                squares += 0.5 * std::pow(4.0 * side / std::pow(m * kPi, 2), 2) *
                           octaves.window(static_cast<int>(j), m * kPi / side);
        EXPECT_NEAR(spectrum.octaveAmplitudes[j] / std::sqrt(squares), 1.0, 0.01)
            << "basis " << basisSize;
    }
}

TEST(GeometrySpectrum, DoesNotDependOnTheResolutionForLargeFeatures) {
    // Many octaves lie between the largest features and the edges: no Krylov space resolves them
    // all.
    const auto wavy = [](int count) {
        Mesh mesh = testing::rectangle(2.0, 1.0, 2 * count, count);
        for (Index i = 0; i < mesh.V.rows(); ++i)
            mesh.V(i, 2) = 0.05 * std::sin(3.0 * mesh.V(i, 0)) * std::cos(9.0 * mesh.V(i, 1));
        return spectrumOf(mesh, 0);
    };
    const GeometrySpectrum coarse = wavy(48), fine = wavy(240);
    EXPECT_LT(fine.mismatch, 1e-3);
    ASSERT_NEAR(fine.octaveFeatureSizes[0] / coarse.octaveFeatureSizes[0], 1.0, 1e-3);
    for (Index j = 0; j < 4; ++j)
        EXPECT_NEAR(fine.octaveEnergies[j] / coarse.octaveEnergies[j], 1.0, 0.03) << j;
}

TEST(GeometrySpectrum, ScalesWithTheMeshAndIsInvariantUnderTranslation) {
    for (const Mesh& mesh : classesOfMeshes()) {
        const GeometrySpectrum original = spectrumOf(mesh, 30);
        for (const double scale : {1e-5, 1e4}) {
            const Vertices V = (scale * mesh.V).rowwise() + scale * Eigen::RowVector3d(50, -30, 20);
            const GeometrySpectrum scaled = geometrySpectrum(V, mesh.F, withBasis(30));
            ASSERT_EQ(scaled.octaveEnergies.size(), original.octaveEnergies.size());
            EXPECT_LT((scaled.octaveFeatureSizes / scale - original.octaveFeatureSizes)
                          .cwiseAbs()
                          .maxCoeff(),
                      1e-9 * original.diagonal);
            EXPECT_LT((scaled.octaveAmplitudes / scale)
                          .cwiseQuotient(original.octaveAmplitudes)
                          .maxCoeff(),
                      1.0 + 1e-3);
            EXPECT_NEAR(scaled.featureSize90 / scale / original.featureSize90, 1.0, 1e-6);
            EXPECT_NEAR(scaled.totalEnergy / std::pow(scale, 4) / original.totalEnergy, 1.0, 1e-9);
        }
    }
}

TEST(GeometrySpectrum, DoesNotDependOnThePositionOfParts) {
    const Mesh one = testing::blob();
    Mesh other = one;
    other.V.rowwise() += Eigen::RowVector3d(3, 0, 0);
    const GeometrySpectrum near = spectrumOf(testing::joined(one, other), 30);
    other.V.rowwise() += Eigen::RowVector3d(0, 500, 0);
    const GeometrySpectrum far = spectrumOf(testing::joined(one, other), 30);
    EXPECT_NEAR(far.totalEnergy / near.totalEnergy, 1.0, 1e-9);
    EXPECT_NEAR(far.featureSize90 / near.featureSize90, 1.0, 1e-6);
    EXPECT_EQ(near.amplitudes.head(2).maxCoeff(), 0.0);
}

TEST(GeometrySpectrum, HasAllHarmonicsOfTinyMeshes) {
    Mesh triangle{Vertices(3, 3), Faces(1, 3)};
    triangle.V << 0, 0, 0, 1, 0, 0, 0, 2, 0;
    triangle.F << 0, 1, 2;
    for (const Mesh& mesh : {triangle, testing::icosphere(0), testing::cube(1),
                             testing::joined(triangle, testing::icosphere(0))})
        for (const LaplacianKind kind :
             {LaplacianKind::Cotangent, LaplacianKind::IntrinsicDelaunay}) {
            const GeometrySpectrum all = geometrySpectrum(mesh.V, mesh.F, withBasis(200, kind));
            EXPECT_EQ(all.frequencies.size(), mesh.V.rows());
            EXPECT_NEAR(all.octaveEnergies.sum() / all.totalEnergy, 1.0, 1e-12);
            EXPECT_GT(all.featureSize99, 0.0);
            const GeometrySpectrum none = geometrySpectrum(mesh.V, mesh.F, withBasis(0, kind));
            EXPECT_EQ(none.frequencies.size(), 0);
            EXPECT_NEAR(none.octaveEnergies.sum() / none.totalEnergy, 1.0, 1e-12);
            EXPECT_NEAR(none.featureSize50 / all.featureSize50, 1.0, 1e-6);
            // A basis with room for the constants only is enlarged.
            EXPECT_GT(geometrySpectrum(mesh.V, mesh.F, withBasis(1, kind)).frequencies.size(), 1);
        }
}

TEST(GeometrySpectrum, DoesNotChangeWithATinyPart) {
    // Its frequencies are so high that those of the shape are lost in round-off of products with A.
    const Mesh shape = testing::blob();
    const GeometrySpectrum alone = spectrumOf(shape, 0);
    for (const double scale : {1e-3, 1e-4, 1e-5, 1e-6, 1e-7}) {
        Mesh tiny = testing::icosphere(1);
        tiny.V *= scale;
        const GeometrySpectrum both = spectrumOf(testing::joined(shape, tiny), 0);
        EXPECT_NEAR(both.octaveFeatureSizes[0] / alone.octaveFeatureSizes[0], 1.0, 1e-6) << scale;
        EXPECT_LT(both.mismatch, 1e-3) << scale;
        for (Index j = 0; j + 1 < alone.octaveEnergies.size(); ++j)  // the last includes all beyond
            EXPECT_NEAR(both.octaveEnergies[j] / alone.octaveEnergies[j], 1.0, 0.01) << scale;
    }
}

TEST(GeometrySpectrum, AcceptsSingleTrianglesWhateverTheirNoise) {
    // With many triangles, the random signs are equal at all corners of some.
    for (int count = 1; count <= 12; ++count) {
        Mesh mesh{Vertices(0, 3), Faces(0, 3)};
        for (int i = 0; i < count; ++i) {
            Mesh triangle{Vertices(3, 3), Faces(1, 3)};
            triangle.V << i, 0, 0, i + 0.5, 0, 0, i, 0, 0.4;
            triangle.F << 0, 1, 2;
            mesh = i == 0 ? triangle : testing::joined(mesh, triangle);
        }
        const GeometrySpectrum spectrum = spectrumOf(mesh, 0);
        EXPECT_GT(spectrum.featureSize99, 0.0) << count;
        EXPECT_TRUE(spectrum.octaveEnergies.allFinite()) << count;
    }
}

TEST(GeometrySpectrum, HasNoEmptyOctavesForATriangleWithoutArea) {
    Mesh mesh = testing::blob();
    const Index octaves = spectrumOf(mesh, 20).octaveEnergies.size();
    mesh.V.row(mesh.F(0, 0)) = mesh.V.row(mesh.F(0, 1));
    const GeometrySpectrum spectrum =
        geometrySpectrum(mesh.V, mesh.F, withBasis(20, LaplacianKind::IntrinsicDelaunay));
    const Index last = spectrum.octaveEnergies.size() - 1;
    EXPECT_GT(spectrum.octaveEnergies[last], 0.0);
    EXPECT_EQ(spectrum.octaveFeatureSizes.size(), last + 1);
    EXPECT_EQ(spectrum.cumulativeEnergy.size(), last + 1);
    EXPECT_LT(last, 3 * octaves);
    EXPECT_NEAR(spectrum.octaveEnergies.sum() / spectrum.totalEnergy, 1.0, 1e-12);
}

}  // namespace
}  // namespace spectral
