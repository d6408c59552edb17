// The spectrum of a shape with a fixed boundary, and the effect of a boundary.

#include <gtest/gtest.h>

#include <cmath>

#include "core/laplacian/interior.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
#include "support/geometry_spectra.h"
#include "support/shapes.h"

namespace spectral {
namespace {

using testing::Mesh;
using testing::spectrumOf;

TEST(GeometrySpectrumWithFixedBoundary, ShowsOnlyAWaveThatVanishesOnTheBoundary) {
    // Height e sin(p pi x / a) sin(q pi y / b) on a flat rectangle a x b, whose plane is determined
    // by its boundary: a single harmonic with root mean square e / 2.
    const double a = 2.0, b = 1.0, e = 1e-3;
    const int p = 5, q = 4;
    Mesh mesh = testing::rectangle(a, b, 96, 48);
    for (Index i = 0; i < mesh.V.rows(); ++i)
        mesh.V(i, 2) =
            e * std::sin(p * kPi * mesh.V(i, 0) / a) * std::sin(q * kPi * mesh.V(i, 1) / b);
    const double featureSize = 2.0 / std::hypot(p / a, q / b);
    for (const int basisSize : {4, 100}) {  // the wave is beyond the basis, or in it
        const GeometrySpectrum spectrum = spectrumOf(mesh, basisSize, Boundary::Fixed);
        EXPECT_NEAR(std::sqrt(spectrum.totalEnergy / spectrum.area) / (e / 2), 1.0, 0.01);
        EXPECT_NEAR(std::log2(spectrum.featureSize50 / featureSize), 0.0,
                    basisSize == 100 ? 0.01 : 0.5);
    }
    // With a free boundary the plane itself has energy.
    EXPECT_GT(spectrumOf(mesh, 20).octaveAmplitudes.maxCoeff(), 0.5);
}

TEST(GeometrySpectrumWithFixedBoundary, FallsFasterThanWithAFreeBoundary) {
    // The cosine coefficients of x on a rectangle with free boundary are 1 / m^2: 2^1.5 per octave.
    // The sine coefficients of a dome x (a - x) y (b - y), which is curved at the boundary, are
    // 1 / m^3: 2^2.5.
    const double a = 2.0, b = 1.6;
    Mesh mesh = testing::rectangle(a, b, 120, 96);
    const auto slope = [&](Boundary boundary) {
        const GeometrySpectrum spectrum = spectrumOf(mesh, 50, boundary);
        return std::log2(spectrum.octaveAmplitudes[2] / spectrum.octaveAmplitudes[5]) / 3.0;
    };
    EXPECT_NEAR(slope(Boundary::Free), 1.5, 0.15);
    for (Index i = 0; i < mesh.V.rows(); ++i) {
        const double x = mesh.V(i, 0), y = mesh.V(i, 1);
        mesh.V(i, 2) = 1e-3 * x * (a - x) * y * (b - y);
    }
    EXPECT_NEAR(slope(Boundary::Fixed), 2.5, 0.25);
}

TEST(GeometrySpectrumWithFixedBoundary, EqualsTheFreeSpectrumOnAClosedMesh) {
    const Mesh mesh = testing::blob();
    const GeometrySpectrum free = spectrumOf(mesh, 30),
                           fixed = spectrumOf(mesh, 30, Boundary::Fixed);
    EXPECT_EQ(free.octaveEnergies, fixed.octaveEnergies);
    EXPECT_EQ(free.frequencies, fixed.frequencies);
}

TEST(GeometrySpectrumWithFixedBoundary, IsOneFrequencyForASingleInteriorVertex) {
    Mesh roof = testing::rectangle(2, 2, 2, 2);
    roof.V(4, 2) = 0.5;  // the middle
    const GeometrySpectrum spectrum = spectrumOf(roof, 200, Boundary::Fixed);
    EXPECT_EQ(spectrum.frequencies.size(), 1);
    EXPECT_GT(spectrum.totalEnergy, 0.0);
    EXPECT_EQ(spectrum.octaveEnergies.size(), 1);
}

}  // namespace
}  // namespace spectral
