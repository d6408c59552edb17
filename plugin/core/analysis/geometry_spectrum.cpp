#include "core/analysis/geometry_spectrum.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "core/analysis/bands.h"
#include "core/analysis/noise_floor.h"
#include "core/analysis/spectral_measure.h"
#include "core/harmonics/truncated_basis.h"
#include "core/laplacian/harmonic_extension.h"
#include "core/mesh/measures.h"
#include "core/support/threads.h"

namespace spectral {

namespace {

/// Largest number of vertices for which a basis as large as the mesh is computed: a dense problem
/// that takes seconds.
constexpr Index kMaxWholeBasis = 2000;

/// Fraction of the progress for the basis; the rest is for the energies beyond it.
constexpr double kBasisDone = 0.6;

/// Relative energy below which all is round-off: the square of a relative amplitude of 1e-13.
constexpr double kNoEnergy = 1e-26;

/// Relative size below which a signal is round-off from the solve for the harmonic extension.
constexpr double kNoShape = 1e-11;

/// Number of harmonics, or equivalent noise, below which the noise height of a band is too
/// uncertain: the amplitude of n random coefficients scatters by up to 1/sqrt(2 n), 13 %.
constexpr double kMinHarmonics = 30.0;

/// Lower bound of the first eigenvalue relative to its scale 4 pi / area; bounds the number of
/// octaves. Only a surface a million times as long as wide would be below it.
constexpr double kLowest = 1e-6;

/// Dimensions of Krylov spaces: around a pole, enough for its octave and two or three on each side;
/// for products with A, for the highest four or so.
constexpr int kPoleDimension = 36, kProductsDimension = 144;

/// The first pole is at this multiple of the number of computed harmonics, by Weyl's law: a few
/// octaves above the lowest ones, which converge best.
constexpr double kPoleHarmonic = 32.0;

/// Largest relative change of the energy of an octave; beyond it, the octave gets its own pole. The
/// error is several times smaller, as the space has grown by half. Third octaves are not checked:
/// they are only plotted and fitted to noise.
constexpr double kConverged = 0.02;

/// The analysed signal, and the Laplacian of its vertices.
struct Signal {
    Laplacian laplacian;
    Eigen::MatrixXd U;  ///< Positions minus their means, or minus their harmonic extension.
};

Signal signalOf(MeshLaplacian mesh, Boundary boundary) {
    const Interior interior(mesh.surface.F, mesh.components, boundary);
    if (interior.isWhole()) {
        Eigen::MatrixXd U = std::move(mesh.surface.X);
        // The second time takes round-off of the first, where components are far apart.
        for (int time = 0; time < 2; ++time) mesh.laplacian.constants.remove(mesh.laplacian.D, U);
        return {std::move(mesh.laplacian), std::move(U)};
    }
    if (interior.size() == 0)
        throw InvalidOption(
            ErrorCode::BoundaryFixesAll,
            "boundary = fixed leaves nothing to measure: every vertex is on the boundary");
    Laplacian inside = interior.restricted(mesh.laplacian);
    HarmonicExtension::Remainder remainder =
        HarmonicExtension(interior).remainder(mesh.laplacian, inside, mesh.surface.X);
    if (remainder.relativeSize <= kNoShape)
        throw InvalidOption(ErrorCode::BoundaryFixesAll,
                            "boundary = fixed leaves nothing to measure: the boundary determines "
                            "the whole surface, as on a flat one");
    inside.constants.remove(inside.D, remainder.U);
    return {std::move(inside), std::move(remainder.U)};
}

/// Number of harmonics to compute; on a small mesh at most as many as it has.
Index sizeOfBasis(int requested, Index vertices, int components) {
    if (requested < 0)
        throw InvalidOption("basis_size = " + std::to_string(requested) +
                            ": must be 0, for no individual harmonics, or above");
    if (requested == 0) return 0;
    const Index size = std::max(requested, components + 1);
    return vertices <= kMaxWholeBasis ? std::min(size, vertices) : size;
}

/// |X|_D^2 over all columns.
double energyOf(const Eigen::MatrixXd& X, const Eigen::VectorXd& D) {
    return X.rowwise().squaredNorm().dot(D);
}

/// Random signs: white noise whose energies have the least variance.
Eigen::VectorXd noiseOfUnitHeight(Index vertices) {
    std::mt19937 bits(1);  // fixed, for reproducible results
    return Eigen::VectorXd::NullaryExpr(vertices, [&] { return bits() & 1U ? 1.0 : -1.0; });
}

/// The measures of a shape and of noise of height 1, and the bands that cover their frequencies.
struct MeasuredBands {
    ShapeAndNoise measures;
    Bands octaves, thirds;
};

/// @param measures  its first space has the lowest frequencies, its last one the highest.
MeasuredBands withBands(ShapeAndNoise measures, const GeometrySpectrum& spectrum) {
    // The noise contains all harmonics, and extreme Ritz values converge first. On a mesh of a few
    // vertices, though, all random signs may be equal, and the noise contains none.
    const Eigen::VectorXd low = measures.noise.first().omega, high = measures.noise.last().omega;
    const double lowest = std::max(low.size() > 0 ? low.minCoeff() : 0.0,
                                   std::sqrt(kLowest * 4.0 * kPi / spectrum.area));
    const double highest = std::max(lowest, high.size() > 0 ? high.maxCoeff() : 0.0);
    return {std::move(measures),
            {spectrum.surfaceDiagonal, lowest, highest},
            {spectrum.surfaceDiagonal, lowest, highest, 3}};
}

/// Adds to the measures in a basis those beyond it.
///
/// The lowest octaves come from a space with a pole, the highest from products with A. If these do
/// not meet, as on large meshes or with needle triangles, octaves in between get poles of their
/// own.
/// @param signals    n x 4, orthogonal to the basis: the shape, then the noise.
/// @param firstPole  frequency of the first pole.
MeasuredBands measureBeyond(ShapeAndNoise measures, const Signal& signal,
                            const Eigen::MatrixXd& signals, double firstPole, ShiftedLdlt& ldlt,
                            const Progress& progress, const GeometrySpectrum& spectrum) {
    const Laplacian& laplacian = signal.laplacian;
    const auto addPole = [&](double omega, ShapeAndNoise& to, double begin, double end) {
        progress.report(begin, "energies of the octaves");
        ldlt.factorizeDefinite(laplacian.W, laplacian.D, omega * omega);
        addMeasures(ShiftInvert(ldlt), laplacian, signals, kPoleDimension,
                    progress.part(begin, end), to);
    };
    double done = 0.4;
    addPole(firstPole, measures, 0.0, done);
    const Products A(laplacian, std::numeric_limits<double>::infinity());
    addMeasures(A, laplacian, signals, kProductsDimension, progress.part(done, 2.0 * done),
                measures);
    MeasuredBands bands = withBands(std::move(measures), spectrum);

    const double negligible = kNoEnergy * spectrum.totalEnergy;
    std::vector<bool> hasPole(static_cast<std::size_t>(bands.octaves.count()));
    for (done *= 2.0;;) {
        std::vector<int> open;
        for (int j = 0; j < bands.octaves.count(); ++j) {
            const auto [energy, change] = bands.measures.shape.in(bands.octaves, j);
            if (!hasPole[j] && !(change <= kConverged * energy + negligible)) open.push_back(j);
        }
        if (open.empty()) return bands;
        const int middle = open[open.size() / 2];
        hasPole[middle] = true;
        const double next = 0.5 * (done + 1.0);
        addPole(2.0 * kPi / bands.octaves.featureSize(middle), bands.measures, done, next);
        done = next;
    }
}

/// The measures of the shape and the noise in the harmonics of a basis and beyond it.
MeasuredBands measureSignals(const Signal& signal, const HarmonicBasis& basis, ShiftedLdlt& ldlt,
                             const Progress& progress, const GeometrySpectrum& spectrum) {
    const Eigen::VectorXd& D = signal.laplacian.D;
    const Index n = D.size();
    const Index varying = std::max<Index>(0, basis.size() - signal.laplacian.constants.count());
    const Eigen::VectorXd omega = spectrum.frequencies.tail(varying);
    // In the basis, use the expectation sum_v (phi_i(v) D_v)^2 of the noise energy; bands beyond it
    // have enough harmonics for a random sample.
    ShapeAndNoise measures{
        SpectralMeasure({omega, spectrum.amplitudes.tail(varying).cwiseAbs2() * spectrum.area}),
        SpectralMeasure(
            {omega,
             (D.asDiagonal() * basis.Phi.rightCols(varying)).colwise().squaredNorm().transpose()})};
    if (basis.size() == n) return withBands(std::move(measures), spectrum);
    Eigen::MatrixXd signals(n, signal.U.cols() + 1);
    signals << signal.U, noiseOfUnitHeight(n);
    if (basis.size() > 0) signals -= basis.inverseTransform(basis.transform(D, signals));
    if (energyOf(signals.leftCols(signal.U.cols()), D) <= kNoEnergy * spectrum.totalEnergy)
        signals.leftCols(signal.U.cols()).setZero();
    // By Weyl's law, area omega^2 / (4 pi) frequencies are below omega.
    const double firstPole = std::sqrt(4.0 * kPi / spectrum.area * kPoleHarmonic *
                                       static_cast<double>(std::max<Index>(1, varying)));
    return measureBeyond(std::move(measures), signal, signals, firstPole, ldlt, progress, spectrum);
}

void setOctaves(const MeasuredBands& bands, GeometrySpectrum& spectrum) {
    const Bands& octaves = bands.octaves;
    Eigen::VectorXd energies(octaves.count());
    for (int j = 0; j < octaves.count(); ++j) {
        const auto [energy, change] = bands.measures.shape.in(octaves, j);
        energies[j] = energy;
        spectrum.mismatch += change / spectrum.totalEnergy;
    }
    // Drop empty octaves at the end: a triangle of almost no area has very high frequencies, but no
    // energy in them.
    Index filled = octaves.count();
    while (filled > 0 && !(energies[filled - 1] > kNoEnergy * spectrum.totalEnergy)) --filled;
    if (filled == 0)
        throw SolverFailure(
            "the shape is lost in round-off: its parts are tiny compared with their distance");
    spectrum.octaveFeatureSizes.resize(filled);
    for (int j = 0; j < filled; ++j) spectrum.octaveFeatureSizes[j] = octaves.featureSize(j);
    const double sum = energies.head(filled).sum();
    spectrum.mismatch = std::max(spectrum.mismatch, std::abs(sum / spectrum.totalEnergy - 1.0));
    spectrum.octaveEnergies = energies.head(filled) * (spectrum.totalEnergy / sum);
    spectrum.octaveAmplitudes = (spectrum.octaveEnergies / spectrum.area).cwiseSqrt();
    spectrum.cumulativeEnergy.resize(filled);
    std::partial_sum(spectrum.octaveEnergies.begin(), spectrum.octaveEnergies.end(),
                     spectrum.cumulativeEnergy.begin());
    spectrum.cumulativeEnergy /= spectrum.cumulativeEnergy[filled - 1];
}

/// Sets the third octaves with enough harmonics, and where noise begins.
void setBands(const MeasuredBands& bands, Index vertices, GeometrySpectrum& spectrum) {
    const Bands& thirds = bands.thirds;
    const double minEnergy = kMinHarmonics / static_cast<double>(vertices) * spectrum.area;
    std::vector<double> featureSizes, amplitudes, noise;
    for (int t = 0; t < thirds.count(); ++t) {
        const double noiseEnergy = bands.measures.noise.in(thirds, t).energy;
        if (noiseEnergy < minEnergy) continue;
        featureSizes.push_back(thirds.featureSize(t));
        amplitudes.push_back(std::sqrt(bands.measures.shape.in(thirds, t).energy / spectrum.area));
        noise.push_back(std::sqrt(noiseEnergy / spectrum.area));
    }
    const auto vectorOf = [](const std::vector<double>& values) {
        return Eigen::VectorXd::Map(values.data(), static_cast<Index>(values.size()));
    };
    spectrum.bandFeatureSizes = vectorOf(featureSizes);
    spectrum.bandAmplitudes = vectorOf(amplitudes);
    spectrum.bandNoise = vectorOf(noise);
    const Diagnosis& diagnosis = spectrum.diagnosis;
    // Correlated noise has its energy in fewer harmonics.
    spectrum.noiseFeatureSize =
        noiseFeatureSize(diagnosis.rmsHeight() * diagnosis.noise.size, spectrum.bandFeatureSizes,
                         spectrum.bandAmplitudes, spectrum.bandNoise);
}

/// Sets the feature sizes at and above which given fractions of the energy lie, from harmonics or
/// Ritz values. The low ones, with nearly all of the energy, have converged to harmonics.
void setFeatureSizes(const Quadrature& measure, GeometrySpectrum& spectrum) {
    if (measure.omega.size() == 0) return;
    std::vector<Index> order(static_cast<std::size_t>(measure.omega.size()));
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(),
              [&](Index i, Index j) { return measure.omega[i] < measure.omega[j]; });
    const auto sizeHolding = [&](double part) {
        double energy = 0.0;
        for (const Index i : order)
            if ((energy += measure.weight[i]) >= part * spectrum.totalEnergy &&
                measure.omega[i] > 0)
                return 2.0 * kPi / measure.omega[i];
        return 2.0 * kPi / measure.omega[order.back()];
    };
    spectrum.featureSize50 = sizeHolding(0.50);
    spectrum.featureSize90 = sizeHolding(0.90);
    spectrum.featureSize99 = sizeHolding(0.99);
}

/// The lowest k harmonics, all of them, or none.
HarmonicBasis basisOf(const Signal& signal, Index k, ShiftedLdlt& ldlt, const Progress& progress) {
    const Index n = signal.laplacian.D.size();
    if (k == 0) {
        HarmonicBasis none;
        none.Phi.resize(n, 0);
        return none;
    }
    if (k == n && n <= kMaxWholeBasis) return denseBasis(signal.laplacian);
    return truncatedBasis(signal.laplacian, k, ldlt, progress);
}

}  // namespace

GeometrySpectrum geometrySpectrum(const Vertices& V, const Faces& F, const SpectrumOptions& options,
                                  const Progress& progress) {
    const ThreadTeam team(progress);
    MeshLaplacian mesh = meshLaplacian(V, F, options.laplacian);
    GeometrySpectrum spectrum;
    const MeshLengths lengths = lengthsOf(V, F);
    spectrum.diagonal = lengths.diagonal;
    spectrum.surfaceDiagonal = lengths.surfaceDiagonal;
    spectrum.meanEdge = lengths.meanEdge;
    spectrum.area = mesh.laplacian.D.sum();
    spectrum.diagnosis = diagnose(mesh.surface, progress.part(0.0, 0.0));
    spectrum.diagnosis.X.resize(0, 3);
    const Signal signal = signalOf(std::move(mesh), options.boundary);
    const Laplacian& laplacian = signal.laplacian;
    const Eigen::VectorXd& D = laplacian.D;
    const Index n = D.size(), constants = laplacian.constants.count();
    const Index k = sizeOfBasis(options.basisSize, n, laplacian.constants.count());

    ShiftedLdlt ldlt;
    const double basisDone = k > 0 ? kBasisDone : 0.0;
    const HarmonicBasis basis = basisOf(signal, k, ldlt, progress.part(0.0, basisDone));
    const Index varying = std::max<Index>(0, basis.size() - constants);
    spectrum.totalEnergy = energyOf(signal.U, D);
    spectrum.frequencies = basis.lambda.cwiseMax(0.0).cwiseSqrt();
    spectrum.amplitudes = basis.transform(D, signal.U).rowwise().norm() / std::sqrt(spectrum.area);
    spectrum.amplitudes.head(basis.size() - varying).setZero();

    const MeasuredBands bands =
        measureSignals(signal, basis, ldlt, progress.part(basisDone, 1.0), spectrum);
    setOctaves(bands, spectrum);
    setBands(bands, n, spectrum);
    setFeatureSizes(bands.measures.shape.first(), spectrum);
    if (varying > 0) {
        const Eigen::VectorXd residuals =
            relativeResiduals(laplacian, basis, progress.part(1.0, 1.0));
        for (Index i = constants; i < basis.size(); ++i)
            spectrum.mismatch += std::min(1.0, residuals[i]) * std::pow(spectrum.amplitudes[i], 2) *
                                 spectrum.area / spectrum.totalEnergy;
    }
    return spectrum;
}

}  // namespace spectral
