#include "core/analysis/geometry_spectrum.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "core/analysis/bands.h"
#include "core/analysis/noise_floor.h"
#include "core/harmonics/truncated_basis.h"
#include "core/krylov/krylov_spaces.h"
#include "core/laplacian/harmonic_extension.h"
#include "core/mesh/measures.h"
#include "core/support/threads.h"

namespace spectral {

namespace {

/// Vertices up to which a basis as large as the mesh is computed: a dense problem, of seconds.
constexpr Index kWholeBasis = 2000;

/// Share of the progress bar for the basis; the energies beyond it have the rest.
constexpr double kBasisDone = 0.6;

/// Relative energy that is round-off: the square of a relative amplitude of 1e-13.
constexpr double kNoEnergy = 1e-26;

/// A signal of less relative size is round-off of the solve for the harmonic extension.
constexpr double kNoShape = 1e-11;

/// Harmonics, or as much of the noise, below which the noise height of a band is too uncertain:
/// the amplitude of n random coefficients scatters by up to 1/sqrt(2 n), 13 %.
constexpr double kFewHarmonics = 30.0;

/// Lower bound of the first eigenvalue relative to its scale 4 pi / area. Only a surface a million
/// times as long as wide would fall below; it bounds the number of octaves.
constexpr double kLowest = 1e-6;

/// Krylov dimensions of an octave: between checks of its energies, at the first check, at most.
constexpr int kEnergyCheckInterval = 4, kFirstEnergyCheck = 16, kMaxDimension = 120;

/// Largest change of converged energies, relative to themselves. Octaves are scaled to their known
/// sum; third octaves are only plotted, and fitted to noise: a loose tolerance suffices.
constexpr double kConverged = 1e-4, kThirdsConverged = 1e-2;

/// Smaller changes relative to the energy of all bands are ignored: an amplitude of 1e-5 of it.
constexpr double kNegligible = 1e-10;

/// The signal that is analysed, and the Laplacian of its vertices.
struct Signal {
    Laplacian laplacian;
    ConstantModes constants;
    Eigen::MatrixXd U;  ///< Positions without their means, or without their harmonic extension.
};

Signal signalOf(MeshLaplacian mesh, Boundary boundary) {
    const Interior interior(mesh.surface.F, mesh.components, boundary);
    if (interior.isWhole()) {
        Eigen::MatrixXd U = std::move(mesh.surface.X);
        mesh.constants.remove(U);
        mesh.constants.remove(U);  // again: the round-off of components far apart
        return {std::move(mesh.laplacian), std::move(mesh.constants), std::move(U)};
    }
    if (interior.size() == 0)
        throw InvalidOption(
            ErrorCode::BoundaryFixesAll,
            "boundary = fixed leaves nothing to measure: every vertex is on the boundary");
    HarmonicExtension extension(interior);
    extension.setLaplacian(mesh.laplacian);
    HarmonicExtension::Rest rest = extension.rest(mesh.surface.X);
    if (rest.relativeSize <= kNoShape)
        throw InvalidOption(ErrorCode::BoundaryFixesAll,
                            "boundary = fixed leaves nothing to measure: the boundary determines "
                            "the whole surface, as it does a flat one");
    Laplacian laplacian = interior.restricted(mesh.laplacian);
    ConstantModes constants(interior.components(), laplacian.D);
    constants.remove(rest.U);
    return {std::move(laplacian), std::move(constants), std::move(rest.U)};
}

/// Number of harmonics to compute; on a small mesh at most as many as it has.
Index sizeOfBasis(int asked, Index vertices, int components) {
    if (asked < 1)
        throw InvalidOption("basis_size = " + std::to_string(asked) + ": must be at least 1");
    const Index size = std::max(asked, components + 1);
    return vertices <= kWholeBasis ? std::min(size, vertices) : size;
}

/// |X|_D^2 over all columns.
double energyOf(const Eigen::MatrixXd& X, const Eigen::VectorXd& D) {
    return X.rowwise().squaredNorm().dot(D);
}

/// Random signs: the white noise whose energies have the least variance.
Eigen::VectorXd noiseOfUnitHeight(Index vertices) {
    std::mt19937 bits(1);  // fixed, for reproducible results
    return Eigen::VectorXd::NullaryExpr(vertices, [&] { return bits() & 1U ? 1.0 : -1.0; });
}

/// Energies in octaves and in third octaves.
struct BandEnergies {
    Eigen::VectorXd octaves;  ///< Of the shape.
    Eigen::VectorXd thirds;   ///< Of the shape.
    Eigen::VectorXd noise;    ///< Of the noise, in third octaves.
};

/// Energy sum_i e_i g(omega_i) in the window g of band j.
double energyIn(const Bands& bands, int j, const Quadrature& measure) {
    double energy = 0.0;
    for (Index i = 0; i < measure.omega.size(); ++i)
        energy += measure.weight[i] * bands.window(j, measure.omega[i]);
    return energy;
}

Eigen::VectorXd energiesIn(const Bands& bands, const Quadrature& measure) {
    Eigen::VectorXd energies(bands.count());
    for (int j = 0; j < bands.count(); ++j) energies[j] = energyIn(bands, j, measure);
    return energies;
}

/// An energy to be computed: of the shape or of the noise, in one band.
struct WantedEnergy {
    const Bands& bands;
    int band;
    bool isNoise;
    double tolerance;   ///< Largest change of a converged energy, relative to itself.
    double negligible;  ///< Smaller changes are ignored.
    double& energy;     ///< Set to the result.
};

/// @param signals  the shape, then the noise in the last column.
Eigen::ArrayXd energiesOf(const std::vector<WantedEnergy>& wanted, const KrylovSpaces& signals) {
    Eigen::ArrayXd energies = Eigen::ArrayXd::Zero(static_cast<Index>(wanted.size()));
    for (int c = 0; c < signals.columns(); ++c) {
        const Quadrature measure = signals.quadrature(c);
        const bool isNoise = c + 1 == signals.columns();
        for (std::size_t i = 0; i < wanted.size(); ++i)
            if (wanted[i].isNoise == isNoise)
                energies[static_cast<Index>(i)] +=
                    energyIn(wanted[i].bands, wanted[i].band, measure);
    }
    return energies;
}

/// The same, in spaces that grow until they have converged.
Eigen::ArrayXd convergedEnergies(const std::vector<WantedEnergy>& wanted, KrylovSpaces signals) {
    const auto haveConverged = [&wanted](const Eigen::ArrayXd& energies,
                                         const Eigen::ArrayXd& change) {
        for (std::size_t i = 0; i < wanted.size(); ++i) {
            const auto e = static_cast<Index>(i);
            if (!(change[e] <= std::max(wanted[i].tolerance * energies[e], wanted[i].negligible)))
                return false;
        }
        return true;
    };
    Eigen::ArrayXd energies = Eigen::ArrayXd::Zero(static_cast<Index>(wanted.size()));
    Eigen::ArrayXd change = energies;
    for (int m = 1; m <= kMaxDimension; ++m) {
        if (!signals.extend()) return energiesOf(wanted, signals);
        if (m % kEnergyCheckInterval != 0) continue;
        const Eigen::ArrayXd before = energies, changeBefore = change;
        energies = energiesOf(wanted, signals);
        change = (energies - before).abs();
        // Two in a row: one small change may be a coincidence.
        if (m >= kFirstEnergyCheck && haveConverged(energies, change.max(changeBefore))) break;
    }
    return energies;
}

/// The energies x^T D g(sqrt(A)) x of signals orthogonal to a basis, by Gauss quadrature in
/// shift-invert Krylov spaces with poles at the centres of the octaves.
/// @param lastOfBasis  highest frequency of the basis; bands that end below it get 0.
BandEnergies energiesBeyond(const Bands& octaves, const Bands& thirds, const Signal& signal,
                            double lastOfBasis, const Eigen::MatrixXd& shape,
                            const Eigen::VectorXd& noise, ShiftedLdlt& ldlt,
                            const Progress& progress) {
    const auto& [W, D] = signal.laplacian;
    Eigen::MatrixXd signals(shape.rows(), shape.cols() + 1);
    signals << shape, noise;
    const double negligible = kNegligible * energyOf(shape, D);
    const double negligibleNoise = kNegligible * energyOf(noise, D);

    BandEnergies beyond{Eigen::VectorXd::Zero(octaves.count()),
                        Eigen::VectorXd::Zero(thirds.count()),
                        Eigen::VectorXd::Zero(thirds.count())};
    for (int j = 0; j < octaves.count(); ++j) {
        // The octave and the third octaves around its centre share Krylov spaces.
        std::vector<WantedEnergy> wanted{
            {octaves, j, false, kConverged, negligible, beyond.octaves[j]}};
        for (int t = 0; t < thirds.count(); ++t) {
            if (thirds.end(t) <= lastOfBasis || octaves.nearest(thirds.featureSize(t)) != j)
                continue;
            wanted.push_back({thirds, t, false, kThirdsConverged, negligible, beyond.thirds[t]});
            wanted.push_back({thirds, t, true, kThirdsConverged, negligibleNoise, beyond.noise[t]});
        }
        if (octaves.end(j) <= lastOfBasis && wanted.size() == 1) continue;
        progress.report(static_cast<double>(j) / octaves.count(), "energies of the octaves");
        const double omega = 2.0 * kPi / octaves.featureSize(j);
        ldlt.factorizeDefinite(W, D, omega * omega);
        const ShiftInvert S(ldlt);
        const Eigen::ArrayXd energies =
            convergedEnergies(wanted, KrylovSpaces(S, D, signal.constants, signals));
        for (std::size_t i = 0; i < wanted.size(); ++i)
            wanted[i].energy = energies[static_cast<Index>(i)];
    }
    return beyond;
}

/// The energies of the shape in all bands, and the expected ones of noise of height 1.
///
/// In the basis, the expectation is sum_v (phi_i(v) D_v)^2. Beyond it, a band has so many harmonics
/// that a single sample is close enough.
BandEnergies bandEnergies(const Bands& octaves, const Bands& thirds, const Signal& signal,
                          const HarmonicBasis& basis, ShiftedLdlt& ldlt, const Progress& progress,
                          GeometrySpectrum& spectrum) {
    const Eigen::VectorXd& D = signal.laplacian.D;
    const Index varying = basis.size() - signal.constants.count();
    Quadrature measure{spectrum.frequencies.tail(varying),
                       spectrum.amplitudes.tail(varying).cwiseAbs2() * spectrum.area};
    BandEnergies energies{energiesIn(octaves, measure), energiesIn(thirds, measure), {}};
    measure.weight =
        (D.asDiagonal() * basis.Phi.rightCols(varying)).colwise().squaredNorm().transpose();
    energies.noise = energiesIn(thirds, measure);
    if (basis.size() == D.size()) return energies;

    const auto beyondBasis = [&](const Eigen::MatrixXd& X) {
        return Eigen::MatrixXd(X - basis.inverseTransform(basis.transform(D, X)));
    };
    Eigen::MatrixXd R = beyondBasis(signal.U);
    const double energyOfR = energyOf(R, D);
    if (energyOfR <= kNoEnergy * spectrum.totalEnergy) R.setZero();
    const Eigen::VectorXd noise = beyondBasis(noiseOfUnitHeight(D.size()));
    BandEnergies beyond = energiesBeyond(
        octaves, thirds, signal, spectrum.frequencies[basis.size() - 1], R, noise, ldlt, progress);
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
    // A triangle of nearly no area has very high frequencies, and no energy in them.
    Index filled = octaves.count();
    while (filled > 0 && !(energies[filled - 1] > kNoEnergy * spectrum.totalEnergy)) --filled;
    if (filled == 0)
        throw SolverFailure(
            "round-off leaves nothing of the shape: its parts are tiny compared with their "
            "distance");
    spectrum.octaveFeatureSizes.resize(filled);
    for (int j = 0; j < filled; ++j) spectrum.octaveFeatureSizes[j] = octaves.featureSize(j);
    const double sum = energies.head(filled).sum();  // totalEnergy, up to round-off
    spectrum.octaveEnergies = energies.head(filled) * (spectrum.totalEnergy / sum);
    spectrum.octaveAmplitudes = (spectrum.octaveEnergies / spectrum.area).cwiseSqrt();
    spectrum.cumulativeEnergy.resize(filled);
    std::partial_sum(spectrum.octaveEnergies.begin(), spectrum.octaveEnergies.end(),
                     spectrum.cumulativeEnergy.begin());
    spectrum.cumulativeEnergy /= spectrum.cumulativeEnergy[filled - 1];
}

/// The third octaves with enough harmonics, and their noise floor.
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

/// Feature size at and above which this part of the energy is.
double featureSizeHolding(double part, const GeometrySpectrum& spectrum, const Bands& octaves) {
    const double wanted = part * spectrum.totalEnergy;
    const Eigen::VectorXd& omega = spectrum.frequencies;
    double energy = 0.0;
    for (Index i = 0; i < omega.size(); ++i) {
        energy += std::pow(spectrum.amplitudes[i], 2) * spectrum.area;
        if (omega[i] > 0.0 && energy >= wanted) return 2.0 * kPi / omega[i];
    }
    // Beyond the basis, interpolated in octaves between the edges.
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
    const Signal signal = signalOf(std::move(mesh), options.boundary);
    const Laplacian& laplacian = signal.laplacian;
    const Eigen::VectorXd& D = laplacian.D;
    const Index n = D.size(), constants = signal.constants.count();
    const Index k = sizeOfBasis(options.basisSize, n, signal.constants.count());

    const ThreadTeam team;
    ShiftedLdlt ldlt;
    const HarmonicBasis basis =
        k == n && n <= kWholeBasis
            ? denseBasis(laplacian, signal.constants)
            : truncatedBasis(laplacian, signal.constants, k, ldlt, progress.part(0.0, kBasisDone));
    spectrum.totalEnergy = energyOf(signal.U, D);
    spectrum.frequencies = basis.lambda.cwiseMax(0.0).cwiseSqrt();
    spectrum.amplitudes = basis.transform(D, signal.U).rowwise().norm() / std::sqrt(spectrum.area);
    spectrum.amplitudes.head(constants).setZero();

    const double lowest = std::max(basis.lambda[constants], kLowest * 4.0 * kPi / spectrum.area);
    const double highest =
        std::max(lowest, k == n ? basis.lambda[n - 1] : largestEigenvalue(laplacian));
    const Bands octaves(spectrum.diagonal, std::sqrt(lowest), std::sqrt(highest));
    const Bands thirds(spectrum.diagonal, std::sqrt(lowest), std::sqrt(highest), 3);
    const BandEnergies energies = bandEnergies(octaves, thirds, signal, basis, ldlt,
                                               progress.part(kBasisDone, 1.0), spectrum);
    const Eigen::VectorXd residuals =
        relativeResiduals(laplacian, constants, basis, progress.part(1.0, 1.0));
    for (Index i = constants; i < basis.size(); ++i)
        spectrum.mismatch += std::min(1.0, residuals[i]) * std::pow(spectrum.amplitudes[i], 2) *
                             spectrum.area / spectrum.totalEnergy;
    setOctaves(octaves, energies.octaves, spectrum);
    setBands(thirds, energies, n, spectrum);
    spectrum.featureSize50 = featureSizeHolding(0.50, spectrum, octaves);
    spectrum.featureSize90 = featureSizeHolding(0.90, spectrum, octaves);
    spectrum.featureSize99 = featureSizeHolding(0.99, spectrum, octaves);
    return spectrum;
}

}  // namespace spectral
