#include "core/geometry_spectrum.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>

#include "core/bands.h"
#include "core/errors.h"
#include "core/fractional_filter.h"
#include "core/measures.h"
#include "support/evaluation.h"

namespace spectral {
namespace {

using testing::Mesh;
using testing::Operator;

SpectrumOptions withBasis(int basisSize, LaplacianKind kind = LaplacianKind::Cotangent) {
    SpectrumOptions options;
    options.basisSize = basisSize;
    options.laplacian = kind;
    return options;
}

GeometrySpectrum spectrumOf(const Mesh& mesh, int basisSize, Boundary boundary = Boundary::Free) {
    SpectrumOptions options = withBasis(basisSize);
    options.boundary = boundary;
    return geometrySpectrum(mesh.V, mesh.F, options);
}

std::vector<Mesh> classesOfMeshes() {
    return {testing::blob(), testing::withNoise(testing::rectangle(2, 1, 32, 16), 0.01, 3),
            testing::joined(testing::blob(), testing::torus(2, 0.7, 24, 12)),
            testing::withNoise(testing::icosphere(3), 0.005, 4)};
}

TEST(GeometrySpectrum, HoldsAllOfTheEnergyOfTheShape) {
    for (const Mesh& mesh : classesOfMeshes())
        for (const int basisSize : {4, 50, 200, 5000}) {
            const Operator A(mesh);
            Eigen::MatrixXd X = mesh.V;
            A.constants.remove(X);
            const double energy = X.rowwise().squaredNorm().dot(A.laplacian.D);

            const GeometrySpectrum spectrum = spectrumOf(mesh, basisSize);
            EXPECT_NEAR(spectrum.totalEnergy / energy, 1.0, 1e-12);
            EXPECT_NEAR(spectrum.octaveEnergies.sum() / energy, 1.0, 1e-12);
            EXPECT_NEAR(spectrum.octaveAmplitudes.squaredNorm() * A.area() / energy, 1.0, 1e-12);
            EXPECT_GE(spectrum.octaveEnergies.minCoeff(), 0.0);
            EXPECT_LT(spectrum.mismatch, 1e-3);
            const Index last = spectrum.cumulativeEnergy.size() - 1;
            EXPECT_EQ(spectrum.cumulativeEnergy[last], 1.0);
            for (Index j = 0; j < last; ++j)
                EXPECT_LE(spectrum.cumulativeEnergy[j], spectrum.cumulativeEnergy[j + 1]);
        }
}

void expectWhatAllEigenvectorsSay(const Mesh& mesh, Boundary boundary) {
    const GeometrySpectrum dense = spectrumOf(mesh, static_cast<int>(mesh.V.rows()), boundary);
    EXPECT_EQ(dense.mismatch, 0.0);
    EXPECT_NEAR(dense.amplitudes.squaredNorm() * dense.area / dense.totalEnergy, 1.0, 1e-12);
    for (const int basisSize : {4, 20, 100}) {
        const GeometrySpectrum spectrum = spectrumOf(mesh, basisSize, boundary);
        ASSERT_EQ(spectrum.octaveEnergies.size(), dense.octaveEnergies.size());
        for (Index j = 0; j < dense.octaveEnergies.size(); ++j)
            EXPECT_NEAR(spectrum.octaveEnergies[j] / dense.octaveEnergies[j], 1.0, 2e-3)
                << "basis " << basisSize << ", octave " << j;
        const Index k = spectrum.frequencies.size();
        ASSERT_GE(k, basisSize);
        EXPECT_LT((spectrum.frequencies - dense.frequencies.head(k)).cwiseAbs().maxCoeff(),
                  1e-7 * dense.frequencies[k - 1]);
    }
}

TEST(GeometrySpectrum, IsWhatAllEigenvectorsSay) {
    for (const Mesh& mesh : classesOfMeshes()) {
        EXPECT_EQ(spectrumOf(mesh, static_cast<int>(mesh.V.rows())).frequencies.size(),
                  mesh.V.rows());
        expectWhatAllEigenvectorsSay(mesh, Boundary::Free);
    }
}

TEST(GeometrySpectrum, TellsTheFeatureSizesThatHoldPartsOfTheEnergy) {
    for (const Mesh& mesh : classesOfMeshes()) {
        const GeometrySpectrum dense = spectrumOf(mesh, static_cast<int>(mesh.V.rows()));
        for (const int basisSize : {4, 100}) {
            const GeometrySpectrum spectrum = spectrumOf(mesh, basisSize);
            const double sizes[] = {spectrum.featureSize50, spectrum.featureSize90,
                                    spectrum.featureSize99};
            const double exact[] = {dense.featureSize50, dense.featureSize90, dense.featureSize99};
            const double last = 2.0 * kPi / spectrum.frequencies[spectrum.frequencies.size() - 1];
            for (int part = 0; part < 3; ++part) {
                const double octavesOff = std::abs(std::log2(sizes[part] / exact[part]));
                const bool inBasis = exact[part] > 1.001 * last;
                EXPECT_LT(octavesOff, inBasis ? 1e-6 : 0.75);
            }
        }
    }
}

TEST(GeometrySpectrum, OfASphereIsOneFrequency) {
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

/// Octave whose middle is nearest to a feature size.
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
    for (const int basisSize : {10, 400}) {  // the wave beyond the basis, and within
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

TEST(GeometrySpectrum, ShowsABumpySphereInItsOctaveWithItsAmplitude) {
    // Radius 1 + e P_l(z): a bump in the direction of the normal, whose coordinates are harmonics
    // of l - 1 and l + 1. Its root mean square is e / sqrt(2 l + 1), but for the change of the
    // harmonics with the surface, which is of relative order 1 / l.
    const double e = 0.02;
    const int l = 14;
    Mesh mesh = testing::icosphere(5);
    for (Index i = 0; i < mesh.V.rows(); ++i) {
        const double z = mesh.V(i, 2);
        double before = 1.0, legendre = z;
        for (int d = 1; d < l; ++d) {
            const double next = ((2 * d + 1) * z * legendre - d * before) / (d + 1);
            before = legendre;
            legendre = next;
        }
        mesh.V.row(i) *= 1.0 + e * legendre;
    }
    const GeometrySpectrum spectrum = spectrumOf(mesh, 20);
    const Index j = octaveOf(spectrum, 2.0 * kPi / std::sqrt(l * (l + 1.0)));
    EXPECT_NEAR(spectrum.octaveAmplitudes[j] / (e / std::sqrt(2.0 * l + 1.0)), 1.0, 1.5 / l);
    Eigen::VectorXd others = spectrum.octaveAmplitudes;
    others[j] = others[0] = 0.0;  // octave 0 is the sphere itself
    EXPECT_LT(others.maxCoeff(), 0.1 * spectrum.octaveAmplitudes[j]);
}

TEST(GeometrySpectrum, OfNoiseRisesTowardsSmallFeatures) {
    // As many harmonics are in an octave as are in all larger ones, times three, and each has as
    // much of the noise.
    const GeometrySpectrum spectrum =
        spectrumOf(testing::withNoise(testing::icosphere(4), 1e-3, 5), 100);
    const Index last = spectrum.octaveAmplitudes.size() - 1;
    for (Index j = 2; j <= last; ++j)
        EXPECT_GT(spectrum.octaveAmplitudes[j], 1.6 * spectrum.octaveAmplitudes[j - 1]);
    // Of the three directions of the noise one is across the surface; what moves vertices along it
    // changes no shape, and is not seen. All but its long waves is in these octaves.
    EXPECT_NEAR(spectrum.octaveAmplitudes.tail(last - 1).norm(), 1e-3 / std::sqrt(3.0), 3e-5);
}

/// Open surfaces, one of them beside a closed one.
std::vector<Mesh> openMeshes() {
    return {testing::hemisphere(14), testing::withNoise(testing::rectangle(2, 1, 32, 16), 0.01, 3),
            testing::joined(testing::blob(), testing::withNoise(testing::hemisphere(8), 0.01, 2))};
}

TEST(GeometrySpectrum, TellsTheHeightOfNoiseAndWhereItBegins) {
    // A plate with one wave across it, of the height e, and noise of the height s. Nothing but
    // noise is beyond the wave; with a free boundary there is the rim, too.
    const double e = 0.05;
    const int p = 6;
    for (const double s : {1e-3, 2e-3})
        for (const Boundary boundary : {Boundary::Free, Boundary::Fixed}) {
            Mesh mesh = testing::rectangle(2.0, 1.5, 96, 72);
            for (Index i = 0; i < mesh.V.rows(); ++i)
                mesh.V(i, 2) = e * std::sin(p * kPi * mesh.V(i, 0) / 2.0) *
                               std::sin(p * kPi * mesh.V(i, 1) / 1.5);
            EXPECT_EQ(spectrumOf(mesh, 100, boundary).noiseHeight, 0.0);

            // Uniform in [-a, a]: its height in each direction is a / sqrt(3).
            mesh = testing::withNoise(mesh, std::sqrt(3.0) * s, 7);
            const GeometrySpectrum spectrum = spectrumOf(mesh, 100, boundary);
            EXPECT_NEAR(spectrum.noiseHeight / s, 1.0, boundary == Boundary::Fixed ? 0.1 : 0.2);
            const double wave = 2.0 / std::hypot(p / 2.0, p / 1.5);
            EXPECT_LT(spectrum.noiseFeatureSize, wave);
            EXPECT_GT(spectrum.noiseFeatureSize,
                      (boundary == Boundary::Fixed ? 0.25 : 0.12) * wave);
        }
}

TEST(GeometrySpectrum, TellsWhatNoiseWouldHaveInEveryBand) {
    // All draws of the noise have the mean energy trace(D Phi g Phi^T D), from all eigenvectors.
    const Mesh mesh = testing::blob();
    const GeometrySpectrum dense = spectrumOf(mesh, static_cast<int>(mesh.V.rows()));
    const Operator A(mesh);
    const HarmonicBasis basis = denseBasis(A.laplacian, A.constants);
    const Bands thirds(dense.diagonal, dense.frequencies[1],
                       dense.frequencies[dense.frequencies.size() - 1], 3);
    ASSERT_GT(dense.bandNoise.size(), 4);
    for (Index b = 0; b < dense.bandNoise.size(); ++b) {
        const int t = thirds.nearest(dense.bandFeatureSizes[b]);
        double noise = 0.0, shape = 0.0;
        for (Index i = 1; i < basis.size(); ++i) {
            const double w = thirds.window(t, std::sqrt(basis.lambda[i]));
            noise += w * (A.laplacian.D.asDiagonal() * basis.Phi.col(i)).squaredNorm();
            shape += w * std::pow(dense.amplitudes[i], 2);
        }
        EXPECT_NEAR(dense.bandNoise[b] / std::sqrt(noise / A.area()), 1.0, 1e-6);
        EXPECT_NEAR(dense.bandAmplitudes[b] / std::sqrt(shape), 1.0, 1e-6);
    }
    // One draw, for what is beyond a basis, is near to it.
    const GeometrySpectrum spectrum = spectrumOf(mesh, 30);
    ASSERT_EQ(spectrum.bandNoise.size(), dense.bandNoise.size());
    for (Index b = 0; b < dense.bandNoise.size(); ++b) {
        EXPECT_NEAR(spectrum.bandNoise[b] / dense.bandNoise[b], 1.0, 0.25);
        EXPECT_NEAR(spectrum.bandAmplitudes[b] / dense.bandAmplitudes[b], 1.0, 0.02);
    }
}

TEST(GeometrySpectrumOfAFixedBoundary, IsWhatAllEigenvectorsOfTheInteriorSay) {
    for (const Mesh& mesh : openMeshes()) {
        expectWhatAllEigenvectorsSay(mesh, Boundary::Fixed);
        // By hand: U = X - H, H harmonic, W_II H_I = -W_IB X_B; without its mean where nothing is
        // fixed.
        const Operator A(mesh);
        const Components components = connectedComponents(mesh.F, mesh.V.rows());
        const Interior interior(mesh.F, components, Boundary::Fixed);
        const Laplacian inside = interior.restricted(A.laplacian);
        Eigen::MatrixXd centred = mesh.V;
        A.constants.remove(centred);
        Eigen::MatrixXd U = Eigen::MatrixXd(inside.W).completeOrthogonalDecomposition().solve(
            interior.restricted(Eigen::MatrixXd(A.laplacian.W * centred)));
        const ConstantModes constants(interior.components(), inside.D);
        constants.remove(U);
        const Eigen::VectorXd energies =
            (denseBasis(inside, constants).Phi.transpose() * inside.D.asDiagonal() * U)
                .rowwise()
                .squaredNorm();
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

TEST(GeometrySpectrumOfAFixedBoundary, ShowsAWaveThatIsZeroThereAndNothingElse) {
    // Height e sin(p pi x / a) sin(q pi y / b) on a flat rectangle a x b, whose plane is what its
    // boundary determines: a single harmonic with the root mean square e / 2.
    const double a = 2.0, b = 1.0, e = 1e-3;
    const int p = 5, q = 4;
    Mesh mesh = testing::rectangle(a, b, 96, 48);
    for (Index i = 0; i < mesh.V.rows(); ++i)
        mesh.V(i, 2) =
            e * std::sin(p * kPi * mesh.V(i, 0) / a) * std::sin(q * kPi * mesh.V(i, 1) / b);
    const double featureSize = 2.0 / std::hypot(p / a, q / b);
    for (const int basisSize : {4, 100}) {  // the wave beyond the basis, and within
        const GeometrySpectrum spectrum = spectrumOf(mesh, basisSize, Boundary::Fixed);
        EXPECT_NEAR(std::sqrt(spectrum.totalEnergy / spectrum.area) / (e / 2), 1.0, 0.01);
        EXPECT_NEAR(std::log2(spectrum.featureSize50 / featureSize), 0.0,
                    basisSize == 100 ? 0.01 : 0.5);
    }
    // With a free boundary the plane itself is seen.
    EXPECT_GT(spectrumOf(mesh, 20).octaveAmplitudes.maxCoeff(), 0.5);
}

TEST(GeometrySpectrumOfAFixedBoundary, FallsOffFasterThanThatOfAFreeOne) {
    // The cosines of x on a rectangle are 1 / m^2, those of a free boundary: 2^1.5 per octave. The
    // sines of a dome x (a - x) y (b - y), that is curved at the boundary, are 1 / m^3: 2^2.5.
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

TEST(GeometrySpectrum, IsWhatAFilterWithTheSameBoundaryActsOn) {
    // A filter takes (1 - F)^2 of the energy of every harmonic out of the shape.
    for (const Mesh& mesh : openMeshes())
        for (const Boundary boundary : {Boundary::Free, Boundary::Fixed}) {
            const GeometrySpectrum spectrum =
                spectrumOf(mesh, static_cast<int>(mesh.V.rows()), boundary);
            FilterOptions options;
            options.featureSize = 0.3 * spectrum.diagonal;
            options.steps = 1;
            options.laplacian = LaplacianKind::Cotangent;
            options.boundary = boundary;
            const Vertices moved = fractionalFilter(mesh.V, mesh.F, options).V;

            const TransferFunction gain(options.transferFunction,
                                        cutoffFrequency(options.featureSize));
            double expected = 0.0;
            for (Index i = 0; i < spectrum.frequencies.size(); ++i)
                expected +=
                    std::pow((1.0 - gain(spectrum.frequencies[i])) * spectrum.amplitudes[i], 2);
            const Eigen::VectorXd D = lumpedMass(mesh.V, mesh.F);
            const double removed = (moved - mesh.V).rowwise().squaredNorm().dot(D);
            EXPECT_NEAR(removed / (expected * spectrum.area), 1.0, 1e-4);
        }
}

TEST(GeometrySpectrumOfAFixedBoundary, OfAClosedMeshIsThatOfAFreeOne) {
    const Mesh mesh = testing::blob();
    const GeometrySpectrum free = spectrumOf(mesh, 30),
                           fixed = spectrumOf(mesh, 30, Boundary::Fixed);
    EXPECT_EQ(free.octaveEnergies, fixed.octaveEnergies);
    EXPECT_EQ(free.frequencies, fixed.frequencies);
}

TEST(GeometrySpectrumOfAFixedBoundary, OfASingleVertexInsideIsOneFrequency) {
    Mesh roof = testing::rectangle(2, 2, 2, 2);
    roof.V(4, 2) = 0.5;  // the middle
    const GeometrySpectrum spectrum = spectrumOf(roof, 200, Boundary::Fixed);
    EXPECT_EQ(spectrum.frequencies.size(), 1);
    EXPECT_GT(spectrum.totalEnergy, 0.0);
    EXPECT_EQ(spectrum.octaveEnergies.size(), 1);
}

TEST(GeometrySpectrumOfAFixedBoundary, IsRefusedWhereItLeavesNothing) {
    Mesh flat = testing::rectangle(2, 1, 8, 4);
    flat.V.rowwise() += Eigen::RowVector3d(100, -50, 3);
    for (const Mesh& mesh : {testing::rectangle(1, 1, 1, 1), flat}) {
        try {
            spectrumOf(mesh, 10, Boundary::Fixed);
            FAIL() << "a spectrum of nothing";
        } catch (const InvalidOption& error) {
            EXPECT_NE(std::string(error.what()).find("boundary = free"), std::string::npos);
        }
    }
}

TEST(GeometrySpectrum, ScalesWithTheMeshAndDoesNotChangeUnderTranslation) {
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

TEST(GeometrySpectrum, OfPartsDoesNotDependOnWhereTheyAre) {
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

TEST(GeometrySpectrum, OfTinyMeshesHasAllTheirHarmonics) {
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
            // A basis that has no room for more than the constants is made larger.
            EXPECT_GT(geometrySpectrum(mesh.V, mesh.F, withBasis(1, kind)).frequencies.size(), 1);
        }
}

TEST(GeometrySpectrum, EndsWhereTheShapeDoesEvenIfATriangleHasNoArea) {
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

TEST(GeometrySpectrum, RefusesBadMeshesAndSizes) {
    const Mesh mesh = testing::icosphere(2);
    for (const int basisSize : {0, -3}) EXPECT_THROW(spectrumOf(mesh, basisSize), InvalidOption);
    const Mesh large = testing::icosphere(4);
    try {
        spectrumOf(large, static_cast<int>(large.V.rows()));
        FAIL() << "a dense basis of " << large.V.rows() << " vertices";
    } catch (const InvalidOption& error) {
        EXPECT_NE(std::string(error.what()).find("at most 2561"), std::string::npos);
    }
    EXPECT_THROW(geometrySpectrum(Vertices(0, 3), Faces(0, 3), {}), InvalidMesh);
    EXPECT_THROW(geometrySpectrum(mesh.V, Faces(0, 3), {}), InvalidMesh);
    Mesh broken = mesh;
    broken.V(5, 1) = std::nan("");
    EXPECT_THROW(geometrySpectrum(broken.V, broken.F, {}), InvalidMesh);
}

TEST(GeometrySpectrum, CanBeInterruptedAtAnyStage) {
    const Mesh mesh = testing::blob();
    int reports = 0;
    const Progress counting([&](double, const std::string&) { return ++reports > 0; });
    geometrySpectrum(mesh.V, mesh.F, withBasis(20), counting);
    ASSERT_GT(reports, 3);
    // How often the harmonics report depends on the threads.
    for (int stop = 1; stop <= reports; ++stop) {
        int seen = 0;
        const Progress progress([&](double, const std::string&) { return ++seen < stop; });
        try {
            geometrySpectrum(mesh.V, mesh.F, withBasis(20), progress);
            EXPECT_LT(seen, stop);
        } catch (const Cancelled&) {
            EXPECT_EQ(seen, stop);
        }
    }
}

}  // namespace
}  // namespace spectral
