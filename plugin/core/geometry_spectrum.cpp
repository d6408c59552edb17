#include "geometry_spectrum.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "cholesky.h"
#include "errors.h"
#include "harmonic_basis.h"
#include "harmonic_extension.h"
#include "lanczos.h"
#include "measures.h"
#include "mesh_laplacian.h"
#include "octaves.h"

namespace spectral {

namespace {

/// Vertices up to which the whole basis of a mesh is computed when no smaller one is wanted:
/// seconds.
constexpr Index kWholeBasis = 2000;

/// Part of the progress at which the basis is done.
constexpr double kBasisDone = 0.6;

/// Lanczos dimensions of an octave: from one look at its energy to the next, at least, at most.
constexpr int kCheckInterval = 4, kFirstCheck = 16, kMaxDimension = 120;

/// An octave's energy has converged when it changes no more, relative to itself or to all of the
/// energy beyond the basis.
constexpr double kConverged = 1e-4, kNegligible = 1e-10;

/// What is left of the energy, relative to all of it, when there is nothing left.
constexpr double kRoundOff = 1e-26;

/// Size of a signal beside the shape that is round-off of the harmonic extension.
constexpr double kNoShape = 1e-11;

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

/// Sum over the columns x of R of the energies x^T D g_j(sqrt(A)) x of one octave.
double octaveEnergy(const Octaves& octaves, int j, const std::vector<LanczosColumn>& columns,
                    double pole) {
    double energy = 0.0;
    for (const LanczosColumn& column : columns) {
        const Quadrature measure = column.quadrature(pole);
        for (Index i = 0; i < measure.omega.size(); ++i)
            energy += measure.weight[i] * octaves.window(j, measure.omega[i]);
    }
    return energy;
}

/// The same from a Krylov space that grows until it stays as it is.
double convergedEnergy(const Octaves& octaves, int j, const Vibration& vibration,
                       const Eigen::MatrixXd& R, double energyOfR, ShiftedCholesky& cholesky) {
    const double omega = 2.0 * kPi / octaves.featureSize(j), pole = omega * omega;
    cholesky.factorize(vibration.laplacian, pole);
    const Eigen::VectorXd sqrtD = vibration.laplacian.D.cwiseSqrt();
    std::vector<LanczosColumn> columns;
    for (Index c = 0; c < R.cols(); ++c) columns.emplace_back(sqrtD.cwiseProduct(R.col(c)));
    double energy = 0.0, change = energyOfR;
    for (int m = 1; m <= kMaxDimension; ++m) {
        if (!extendColumns(columns, sqrtD, vibration.constants, cholesky))
            return octaveEnergy(octaves, j, columns, pole);
        if (m % kCheckInterval != 0) continue;
        const double before = energy, changeBefore = change;
        energy = octaveEnergy(octaves, j, columns, pole);
        change = std::abs(energy - before);
        // One small change may be chance.
        const double allowed = std::max(kConverged * energy, kNegligible * energyOfR);
        if (m >= kFirstCheck && std::max(change, changeBefore) <= allowed) break;
    }
    return energy;
}

/// Energies that a remainder R beyond the basis has in every octave; they sum to that of R.
Eigen::VectorXd energiesBeyond(const Octaves& octaves, const Vibration& vibration,
                               double lastOfBasis, const Eigen::MatrixXd& R, double energyOfR,
                               ShiftedCholesky& cholesky, const Progress& progress,
                               double& mismatch) {
    Eigen::VectorXd energies = Eigen::VectorXd::Zero(octaves.count());
    for (int j = 0; j < octaves.count(); ++j) {
        if (octaves.end(j) <= lastOfBasis) continue;  // all of it is in the basis
        progress.report(static_cast<double>(j) / octaves.count(), "energies of the octaves");
        energies[j] = convergedEnergy(octaves, j, vibration, R, energyOfR, cholesky);
    }
    mismatch = std::abs(energies.sum() / energyOfR - 1.0);
    return energies * (energyOfR / energies.sum());
}

/// Feature size at and above which a part of the energy is.
double featureSizeHolding(double part, const GeometrySpectrum& spectrum, const Octaves& octaves) {
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
    spectrum.area = mesh.laplacian.D.sum();
    const Vibration vibration = vibrationOf(std::move(mesh), options.boundary);
    const Laplacian& laplacian = vibration.laplacian;
    const Eigen::VectorXd& D = laplacian.D;
    const Index n = D.size(), constants = vibration.constants.count();
    const Index k = sizeOfBasis(options.basisSize, n, vibration.constants.count());

    ShiftedCholesky cholesky;
    const HarmonicBasis basis = k == n ? denseBasis(laplacian, vibration.constants)
                                       : truncatedBasis(laplacian, vibration.constants, k, cholesky,
                                                        progress.part(0.0, kBasisDone));
    const bool whole = basis.size() == n;

    Eigen::MatrixXd R = vibration.U;
    spectrum.totalEnergy = energyOf(R, D);
    Eigen::MatrixXd coefficients = basis.Phi.transpose() * (D.asDiagonal() * R);
    coefficients.topRows(constants).setZero();
    R.noalias() -= basis.Phi * coefficients;
    const Eigen::VectorXd energies = coefficients.rowwise().squaredNorm();
    const double energyOfR = whole ? 0.0 : energyOf(R, D);
    spectrum.frequencies = basis.lambda.cwiseMax(0.0).cwiseSqrt();
    spectrum.amplitudes = (energies / spectrum.area).cwiseSqrt();

    const double lowest = std::max(basis.lambda[constants], kLowest * 4.0 * kPi / spectrum.area);
    const double highest =
        std::max(lowest, whole ? basis.lambda[n - 1] : largestEigenvalue(laplacian));
    const Octaves octaves(spectrum.diagonal, std::sqrt(lowest), std::sqrt(highest));

    spectrum.octaveEnergies = Eigen::VectorXd::Zero(octaves.count());
    if (energyOfR > kRoundOff * spectrum.totalEnergy)
        spectrum.octaveEnergies =
            energiesBeyond(octaves, vibration, spectrum.frequencies[basis.size() - 1], R, energyOfR,
                           cholesky, progress.part(kBasisDone, 1.0), spectrum.mismatch);
    spectrum.octaveFeatureSizes.resize(octaves.count());
    for (int j = 0; j < octaves.count(); ++j) {
        spectrum.octaveFeatureSizes[j] = octaves.featureSize(j);
        for (Index i = constants; i < basis.size(); ++i)
            spectrum.octaveEnergies[j] += energies[i] * octaves.window(j, spectrum.frequencies[i]);
    }
    // A triangle almost without area has frequencies far beyond all others, and nothing in them.
    Index filled = octaves.count();
    while (spectrum.octaveEnergies[filled - 1] <= kRoundOff * spectrum.totalEnergy) --filled;
    spectrum.octaveEnergies.conservativeResize(filled);
    spectrum.octaveFeatureSizes.conservativeResize(filled);
    spectrum.octaveEnergies *= spectrum.totalEnergy / spectrum.octaveEnergies.sum();  // round-off
    spectrum.octaveAmplitudes = (spectrum.octaveEnergies / spectrum.area).cwiseSqrt();
    spectrum.cumulativeEnergy.resize(filled);
    std::partial_sum(spectrum.octaveEnergies.begin(), spectrum.octaveEnergies.end(),
                     spectrum.cumulativeEnergy.begin());
    spectrum.cumulativeEnergy /= spectrum.cumulativeEnergy[filled - 1];
    spectrum.featureSize50 = featureSizeHolding(0.50, spectrum, octaves);
    spectrum.featureSize90 = featureSizeHolding(0.90, spectrum, octaves);
    spectrum.featureSize99 = featureSizeHolding(0.99, spectrum, octaves);
    return spectrum;
}

}  // namespace spectral
