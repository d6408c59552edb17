#include "core/analysis/geometry_spectrum.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <string>
#include <utility>

#include "core/analysis/band_energies.h"
#include "core/analysis/bands.h"
#include "core/analysis/noise_floor.h"
#include "core/harmonics/harmonic_basis.h"
#include "core/harmonics/truncated_basis.h"
#include "core/laplacian/constant_modes.h"
#include "core/laplacian/harmonic_extension.h"
#include "core/laplacian/interior.h"
#include "core/laplacian/mesh_laplacian.h"
#include "core/ldlt/cholesky.h"
#include "core/mesh/measures.h"
#include "core/mesh/mesh.h"
#include "core/support/errors.h"
#include "core/support/thread_team.h"

namespace spectral {

namespace {

/// Vertices up to which the whole basis of a mesh is computed when no smaller one is wanted:
/// seconds.
constexpr Index kWholeBasis = 2000;

/// Part of the progress at which the basis is done.
constexpr double kBasisDone = 0.6;

/// What is left of the energy, relative to all of it, when there is nothing left.
constexpr double kRoundOff = 1e-26;

/// Size of a signal beside the shape that is round-off of the harmonic extension.
constexpr double kNoShape = 1e-11;

/// Fewer harmonics than this in a band, or as much of the noise, are too few to tell its height by.
constexpr double kFewHarmonics = 30.0;

/// Of the noise that takes the place of all; any will do.
constexpr unsigned kNoiseSeed = 1;

/// The first frequency is no lower than this part of the scale 4 pi / area of the first
/// eigenvalues, were the surface a hair of that proportion.
constexpr double kLowest = 1e-6;

/// What can vibrate: the surface, or its interior where the boundary is fixed.
struct Vibration {
    Laplacian laplacian;
    ConstantModes constants;
    Eigen::MatrixXd U;  ///< The shape that the harmonics make up; its constants are 0.
};

/// The positions less their mean on every component.
Vibration freeVibration(MeshLaplacian mesh) {
    Eigen::MatrixXd U = std::move(mesh.surface.X);
    mesh.constants.remove(U);
    return {std::move(mesh.laplacian), std::move(mesh.constants), std::move(U)};
}

/// The positions less what those of the boundary determine.
Vibration heldVibration(const MeshLaplacian& mesh, const Interior& interior) {
    if (interior.size() == 0)
        throw InvalidOption(
            "boundary = fixed leaves nothing to measure: every vertex is on the boundary. Choose "
            "boundary = free");
    HarmonicExtension extension(interior);
    extension.setLaplacian(mesh.laplacian);
    HarmonicExtension::Rest rest = extension.rest(mesh.surface.X);
    if (rest.relativeSize <= kNoShape)
        throw InvalidOption(
            "boundary = fixed leaves nothing to measure: the surface is what its boundary "
            "determines, as a flat one is. Choose boundary = free");
    Laplacian laplacian = interior.restricted(mesh.laplacian);
    ConstantModes constants(interior.components(), laplacian.D);
    constants.remove(rest.U);
    return {std::move(laplacian), std::move(constants), std::move(rest.U)};
}

Vibration vibrationOf(MeshLaplacian mesh, Boundary boundary) {
    const Interior interior(mesh.surface.F, mesh.components, boundary);
    return interior.isWhole() ? freeVibration(std::move(mesh)) : heldVibration(mesh, interior);
}

/// The harmonics to compute, or all there are.
Index sizeOfBasis(int asked, Index vertices, int components) {
    if (asked < 1)
        throw InvalidOption("basis_size = " + std::to_string(asked) + ": must be at least 1");
    if (asked < vertices || vertices <= kWholeBasis)
        return std::min<Index>(std::max(asked, components + 1), vertices);
    throw InvalidOption("basis_size = " + std::to_string(asked) + " needs more than " +
                        std::to_string(asked) + " vertices; the surface has " +
                        std::to_string(vertices) + ": choose at most " +
                        std::to_string(vertices - 1) + ", 200 is plenty");
}

/// |X|_D^2 over all columns.
double energyOf(const Eigen::MatrixXd& X, const Eigen::VectorXd& D) {
    return X.rowwise().squaredNorm().dot(D);
}

/// A value of 1 or -1 at every vertex, at random: noise whose energies vary least from one draw to
/// the next.
Eigen::VectorXd noiseOfUnitHeight(Index vertices) {
    std::mt19937 bits(kNoiseSeed);
    return Eigen::VectorXd::NullaryExpr(vertices, [&] { return bits() & 1U ? 1.0 : -1.0; });
}

/// Energies sum_i e_i g(omega_i) of the harmonics in every band g, `first` the first of them.
Eigen::VectorXd energiesWithin(const Bands& bands, const Eigen::VectorXd& omega,
                               const Eigen::VectorXd& energies, Index first) {
    Eigen::VectorXd sums = Eigen::VectorXd::Zero(bands.count());
    for (int j = 0; j < bands.count(); ++j)
        for (Index i = first; i < omega.size(); ++i)
            sums[j] += energies[i] * bands.window(j, omega[i]);
    return sums;
}

/// The energies of the shape in every band, and those that noise of height 1 has on average.
///
/// In the basis the mean over all draws of the noise is known, sum_v (phi_i(v) D_v)^2; beyond, one
/// draw is near enough to it, for there are many harmonics in a band.
BandEnergies bandEnergies(const Bands& octaves, const Bands& thirds, const Vibration& vibration,
                          const HarmonicBasis& basis, ShiftedCholesky& cholesky,
                          const Progress& progress, GeometrySpectrum& spectrum) {
    const Eigen::VectorXd& D = vibration.laplacian.D;
    const Index constants = vibration.constants.count();
    const Eigen::MatrixXd Dphi = D.asDiagonal() * basis.Phi;
    const Eigen::VectorXd shapeWithin = spectrum.amplitudes.cwiseAbs2() * spectrum.area;
    const Eigen::VectorXd noiseWithin = Dphi.colwise().squaredNorm();
    BandEnergies energies{
        energiesWithin(octaves, spectrum.frequencies, shapeWithin, constants),
        energiesWithin(thirds, spectrum.frequencies, shapeWithin, constants),
        energiesWithin(thirds, spectrum.frequencies, noiseWithin, constants),
    };
    if (basis.size() == D.size()) return energies;

    Eigen::MatrixXd R = vibration.U;
    R.noalias() -= basis.Phi * (Dphi.transpose() * R);
    const double energyOfR = energyOf(R, D);
    if (energyOfR <= kRoundOff * spectrum.totalEnergy) R.setZero();
    Eigen::VectorXd noise = noiseOfUnitHeight(D.size());
    noise -= basis.Phi * (Dphi.transpose() * noise);
    BandEnergies beyond =
        energiesBeyond(octaves, thirds, vibration.laplacian, vibration.constants,
                       spectrum.frequencies[basis.size() - 1], R, noise, cholesky, progress);
    if (const double sum = beyond.octaves.sum(); sum > 0.0) {
        spectrum.mismatch = std::abs(sum / energyOfR - 1.0);
        beyond.octaves *= energyOfR / sum;
    }
    energies.octaves += beyond.octaves;
    energies.thirds += beyond.thirds;
    energies.noise += beyond.noise;
    return energies;
}

void setOctaves(const Bands& octaves, const Eigen::VectorXd& energies, GeometrySpectrum& spectrum) {
    // A triangle almost without area has frequencies far beyond all others, and nothing in them.
    Index filled = octaves.count();
    while (energies[filled - 1] <= kRoundOff * spectrum.totalEnergy) --filled;
    spectrum.octaveFeatureSizes.resize(filled);
    for (int j = 0; j < filled; ++j) spectrum.octaveFeatureSizes[j] = octaves.featureSize(j);
    const double sum = energies.head(filled).sum();  // totalEnergy, but for round-off
    spectrum.octaveEnergies = energies.head(filled) * (spectrum.totalEnergy / sum);
    spectrum.octaveAmplitudes = (spectrum.octaveEnergies / spectrum.area).cwiseSqrt();
    spectrum.cumulativeEnergy.resize(filled);
    std::partial_sum(spectrum.octaveEnergies.begin(), spectrum.octaveEnergies.end(),
                     spectrum.cumulativeEnergy.begin());
    spectrum.cumulativeEnergy /= spectrum.cumulativeEnergy[filled - 1];
}

/// The thirds of octaves that have enough harmonics.
void setBands(const Bands& thirds, const BandEnergies& energies, Index vertices,
              GeometrySpectrum& spectrum) {
    const double least = kFewHarmonics / static_cast<double>(vertices) * spectrum.area;
    const Index count = (energies.noise.array() >= least).count();
    spectrum.bandFeatureSizes.resize(count);
    spectrum.bandAmplitudes.resize(count);
    spectrum.bandNoise.resize(count);
    Index b = 0;
    for (int t = 0; t < thirds.count(); ++t) {
        if (energies.noise[t] < least) continue;
        spectrum.bandFeatureSizes[b] = thirds.featureSize(t);
        spectrum.bandAmplitudes[b] = std::sqrt(energies.thirds[t] / spectrum.area);
        spectrum.bandNoise[b] = std::sqrt(energies.noise[t] / spectrum.area);
        ++b;
    }
    const NoiseFloor floor =
        noiseFloor(spectrum.bandFeatureSizes, spectrum.bandAmplitudes, spectrum.bandNoise);
    spectrum.noiseHeight = floor.height;
    spectrum.noiseFeatureSize = floor.featureSize;
}

/// Feature size at and above which a part of the energy is.
double featureSizeHolding(double part, const GeometrySpectrum& spectrum, const Bands& octaves) {
    const double wanted = part * spectrum.totalEnergy;
    const Eigen::VectorXd& omega = spectrum.frequencies;
    double energy = 0.0;
    for (Index i = 0; i < omega.size(); ++i) {
        energy += std::pow(spectrum.amplitudes[i], 2) * spectrum.area;
        if (omega[i] > 0.0 && energy >= wanted) return 2.0 * kPi / omega[i];
    }
    // Beyond the basis along straight lines, over octaves, between what is known at the edges.
    double size = 2.0 * kPi / omega[omega.size() - 1];
    for (int j = 0; j < spectrum.cumulativeEnergy.size(); ++j) {
        const double next = octaves.edge(j);
        const double energyThere = spectrum.cumulativeEnergy[j] * spectrum.totalEnergy;
        if (next >= size || energyThere <= energy) continue;
        if (energyThere >= wanted)
            return size * std::pow(next / size, (wanted - energy) / (energyThere - energy));
        size = next;
        energy = energyThere;
    }
    return size;
}

}  // namespace

GeometrySpectrum geometrySpectrum(const Vertices& V, const Faces& F, const SpectrumOptions& options,
                                  const Progress& progress) {
    MeshLaplacian mesh = meshLaplacian(V, F, options.laplacian);
    GeometrySpectrum spectrum;
    spectrum.diagonal = boundingBoxDiagonal(V);
    spectrum.meanEdge = meanEdgeLength(V, F);
    spectrum.area = mesh.laplacian.D.sum();
    const Vibration vibration = vibrationOf(std::move(mesh), options.boundary);
    const Laplacian& laplacian = vibration.laplacian;
    const Eigen::VectorXd& D = laplacian.D;
    const Index n = D.size(), constants = vibration.constants.count();
    const Index k = sizeOfBasis(options.basisSize, n, vibration.constants.count());

    const ThreadTeam team;
    ShiftedCholesky cholesky;
    const HarmonicBasis basis = k == n ? denseBasis(laplacian, vibration.constants)
                                       : truncatedBasis(laplacian, vibration.constants, k, cholesky,
                                                        progress.part(0.0, kBasisDone));
    spectrum.totalEnergy = energyOf(vibration.U, D);
    spectrum.frequencies = basis.lambda.cwiseMax(0.0).cwiseSqrt();
    spectrum.amplitudes =
        (basis.Phi.transpose() * (D.asDiagonal() * vibration.U)).rowwise().norm() /
        std::sqrt(spectrum.area);
    spectrum.amplitudes.head(constants).setZero();

    const double lowest = std::max(basis.lambda[constants], kLowest * 4.0 * kPi / spectrum.area);
    const double highest =
        std::max(lowest, k == n ? basis.lambda[n - 1] : largestEigenvalue(laplacian));
    const Bands octaves(spectrum.diagonal, std::sqrt(lowest), std::sqrt(highest));
    const Bands thirds(spectrum.diagonal, std::sqrt(lowest), std::sqrt(highest), 3);
    const BandEnergies energies = bandEnergies(octaves, thirds, vibration, basis, cholesky,
                                               progress.part(kBasisDone, 1.0), spectrum);
    setOctaves(octaves, energies.octaves, spectrum);
    setBands(thirds, energies, n, spectrum);
    spectrum.featureSize50 = featureSizeHolding(0.50, spectrum, octaves);
    spectrum.featureSize90 = featureSizeHolding(0.90, spectrum, octaves);
    spectrum.featureSize99 = featureSizeHolding(0.99, spectrum, octaves);
    return spectrum;
}

}  // namespace spectral
