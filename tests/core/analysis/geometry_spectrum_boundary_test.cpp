// The spectrum of a shape with a fixed boundary, and the effect of a boundary.

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/laplacian/interior.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
#include "core/support/errors.h"
#include "support/dense_eigenpairs.h"
#include "support/evaluation.h"
#include "support/geometry_spectra.h"

namespace spectral {
namespace {

using testing::Mesh;
using testing::Operator;
using testing::spectrumOf;

/// Open surfaces, the last one joined with a closed one.
std::vector<Mesh> openMeshes() {
    return {testing::hemisphere(14), testing::withNoise(testing::rectangle(2, 1, 32, 16), 0.01, 3),
            testing::joined(testing::withNoise(testing::icosphere(2), 0.05, 5),
                            testing::withNoise(testing::hemisphere(8), 0.01, 2))};
}

TEST(GeometrySpectrumWithFixedBoundary, AgreesWithAllEigenvectorsOfTheInterior) {
    for (const Mesh& mesh : openMeshes()) {
        // By hand: U = X - H, H harmonic, W_II H_I = -W_IB X_B; minus the mean if none is fixed.
        const Operator A(mesh);
        const Components components = connectedComponents(mesh.F, mesh.V.rows());
        const Interior interior(mesh.F, components, Boundary::Fixed);
        const Laplacian inside = interior.restricted(A);
        Eigen::MatrixXd centred = mesh.V;
        A.constants.remove(A.D, centred);
        const Eigen::MatrixXd WX = interior.restricted(Eigen::MatrixXd(A.W * centred));
        Eigen::MatrixXd U = testing::denseSolution(Eigen::MatrixXd(inside.W), WX);
        inside.constants.remove(inside.D, U);
        const Eigen::VectorXd energies =
            testing::innerProducts(denseBasis(inside).Phi, inside.D, U).rowwise().squaredNorm();
        const GeometrySpectrum spectrum =
            spectrumOf(mesh, static_cast<int>(mesh.V.rows()), Boundary::Fixed);
        ASSERT_EQ(spectrum.amplitudes.size(), energies.size());
        EXPECT_NEAR(spectrum.area / A.area(), 1.0, 1e-12);
        EXPECT_NEAR(spectrum.totalEnergy / energies.sum(), 1.0, 1e-6);
        EXPECT_LT(
            (spectrum.amplitudes.array().square() * A.area() - energies.array()).abs().maxCoeff(),
            1e-6 * energies.maxCoeff());
    }
}

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

TEST(GeometrySpectrumWithFixedBoundary, IsRejectedIfTheBoundaryDeterminesTheWholeShape) {
    Mesh flat = testing::rectangle(2, 1, 8, 4);
    flat.V.rowwise() += Eigen::RowVector3d(100, -50, 3);
    for (const Mesh& mesh : {testing::rectangle(1, 1, 1, 1), flat}) {
        try {
            spectrumOf(mesh, 10, Boundary::Fixed);
            FAIL() << "a spectrum of nothing";
        } catch (const InvalidOption& error) {
            EXPECT_EQ(error.code(), ErrorCode::BoundaryFixesAll);
        }
    }
}

}  // namespace
}  // namespace spectral
