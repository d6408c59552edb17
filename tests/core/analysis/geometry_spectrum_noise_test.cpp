// Noise in the spectrum of a shape.

#include <gtest/gtest.h>

#include <cmath>

#include "core/analysis/bands.h"
#include "core/laplacian/interior.h"
#include "support/evaluation.h"
#include "support/geometry_spectra.h"

namespace spectral {
namespace {

using testing::Mesh;
using testing::Operator;
using testing::spectrumOf;

TEST(GeometrySpectrum, RisesTowardsSmallFeaturesForNoise) {
    // An octave has three times as many harmonics as all coarser ones, each with the same noise.
    const GeometrySpectrum spectrum =
        spectrumOf(testing::withNoise(testing::icosphere(4), 1e-3, 5), 100);
    const Index last = spectrum.octaveAmplitudes.size() - 1;
    for (Index j = 2; j <= last; ++j)
        EXPECT_GT(spectrum.octaveAmplitudes[j], 1.6 * spectrum.octaveAmplitudes[j - 1]);
    // Of the three components of the noise only the normal one changes the shape. These octaves
    // hold all of it but its long waves.
    EXPECT_NEAR(spectrum.octaveAmplitudes.tail(last - 1).norm(), 1e-3 / std::sqrt(3.0), 3e-5);
}

TEST(GeometrySpectrum, ReturnsTheDiagnosisAndTheFeatureSizeOfNoise) {
    // A plate with a single wave of height e and noise of height s. Above the frequency of the wave
    // there is only noise and, with a free boundary, the rim.
    const double e = 0.05;
    const int p = 6;
    for (const double s : {2e-3, 4e-3})
        for (const Boundary boundary : {Boundary::Free, Boundary::Fixed}) {
            Mesh mesh = testing::rectangle(2.0, 1.5, 96, 72);
            for (Index i = 0; i < mesh.V.rows(); ++i)
                mesh.V(i, 2) = e * std::sin(p * kPi * mesh.V(i, 0) / 2.0) *
                               std::sin(p * kPi * mesh.V(i, 1) / 1.5);
            const GeometrySpectrum clean = spectrumOf(mesh, 100, boundary);
            EXPECT_FALSE(clean.diagnosis.isNoise());
            EXPECT_EQ(clean.noiseFeatureSize, 0.0);

            // Uniform in [-a, a]: its height in each direction is a / sqrt(3).
            mesh = testing::withNoise(mesh, std::sqrt(3.0) * s, 7);
            const GeometrySpectrum spectrum = spectrumOf(mesh, 100, boundary);
            EXPECT_NEAR(spectrum.diagnosis.noise.height / s, 1.0, 0.2);
            EXPECT_EQ(spectrum.diagnosis.noise.height,
                      diagnose(joinedSurface(mesh.V, mesh.F)).noise.height);
            const double wave = 2.0 / std::hypot(p / 2.0, p / 1.5);
            EXPECT_LT(spectrum.noiseFeatureSize, wave);
            EXPECT_GT(spectrum.noiseFeatureSize,
                      (boundary == Boundary::Fixed ? 0.25 : 0.12) * wave);
        }
}

TEST(GeometrySpectrum, ReturnsTheAmplitudeOfNoiseInEveryBand) {
    // The expected energy of the noise is trace(D Phi g Phi^T D), over all eigenvectors.
    const Mesh mesh = testing::blob();
    const GeometrySpectrum dense = spectrumOf(mesh, static_cast<int>(mesh.V.rows()));
    const Operator A(mesh);
    const HarmonicBasis basis = denseBasis(A);
    const Bands thirds(dense.diagonal, dense.frequencies[1],
                       dense.frequencies[dense.frequencies.size() - 1], 3);
    ASSERT_GT(dense.bandNoise.size(), 4);
    for (Index b = 0; b < dense.bandNoise.size(); ++b) {
        const int t = thirds.nearest(dense.bandFeatureSizes[b]);
        double noise = 0.0, shape = 0.0;
        for (Index i = 1; i < basis.size(); ++i) {
            const double w = thirds.window(t, std::sqrt(basis.lambda[i]));
            noise += w * (A.D.asDiagonal() * basis.Phi.col(i)).squaredNorm();
            shape += w * std::pow(dense.amplitudes[i], 2);
        }
        EXPECT_NEAR(dense.bandNoise[b] / std::sqrt(noise / A.area()), 1.0, 1e-6);
        EXPECT_NEAR(dense.bandAmplitudes[b] / std::sqrt(shape), 1.0, 1e-6);
    }
    // Beyond a basis a single random sample is used, which is close to it.
    const GeometrySpectrum spectrum = spectrumOf(mesh, 30);
    ASSERT_EQ(spectrum.bandNoise.size(), dense.bandNoise.size());
    for (Index b = 0; b < dense.bandNoise.size(); ++b) {
        EXPECT_NEAR(spectrum.bandNoise[b] / dense.bandNoise[b], 1.0, 0.25);
        EXPECT_NEAR(spectrum.bandAmplitudes[b] / dense.bandAmplitudes[b], 1.0, 0.02);
    }
}

}  // namespace
}  // namespace spectral
