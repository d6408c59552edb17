#include "core/analysis/band_energies.h"

#include <algorithm>
#include <vector>

#include "core/krylov/krylov_spaces.h"
#include "core/laplacian/constant_modes.h"

namespace spectral {

namespace {

/// Lanczos dimensions of an octave: from one look at its energies to the next, at least, at most.
constexpr int kCheckInterval = 4, kFirstCheck = 16, kMaxDimension = 120;

/// Energies have converged when they change no more, relative to themselves or to all of the energy
/// beyond the basis. Thirds are for the eye.
constexpr double kConverged = 1e-4, kThirdsConverged = 1e-2, kNegligible = 1e-10;

/// The bands that one Krylov space is for.
struct Bundle {
    int octave = 0;
    std::vector<int> thirds;
};

std::vector<Bundle> bundles(const Bands& octaves, const Bands& thirds, double lastOfBasis) {
    std::vector<Bundle> all(static_cast<std::size_t>(octaves.count()));
    for (int j = 0; j < octaves.count(); ++j) all[j].octave = j;
    for (int t = 0; t < thirds.count(); ++t)
        if (thirds.end(t) > lastOfBasis)
            all[octaves.nearest(thirds.featureSize(t))].thirds.push_back(t);
    all.erase(std::remove_if(all.begin(), all.end(),
                             [&](const Bundle& bundle) {
                                 return octaves.end(bundle.octave) <= lastOfBasis &&
                                        bundle.thirds.empty();
                             }),
              all.end());
    return all;
}

double energyIn(const Bands& bands, int j, const Quadrature& measure) {
    double energy = 0.0;
    for (Index i = 0; i < measure.omega.size(); ++i)
        energy += measure.weight[i] * bands.window(j, measure.omega[i]);
    return energy;
}

/// The octave's energy, then those of the shape and of the noise in every third.
Eigen::ArrayXd energiesOf(const Bundle& bundle, const Bands& octaves, const Bands& thirds,
                          const KrylovSpaces& signals) {
    const auto count = static_cast<Index>(bundle.thirds.size());
    Eigen::ArrayXd energies = Eigen::ArrayXd::Zero(1 + 2 * count);
    for (int c = 0; c < signals.columns(); ++c) {
        const Quadrature measure = signals.quadrature(c);
        const bool isNoise = c + 1 == signals.columns();
        if (!isNoise) energies[0] += energyIn(octaves, bundle.octave, measure);
        for (Index t = 0; t < count; ++t)
            energies[1 + t + (isNoise ? count : 0)] += energyIn(thirds, bundle.thirds[t], measure);
    }
    return energies;
}

/// The same from a space that grows until they stay as they are.
///
/// @param total  of the shape and of the noise, in all bands.
Eigen::ArrayXd convergedEnergies(const Bundle& bundle, const Bands& octaves, const Bands& thirds,
                                 const Laplacian& laplacian, const ConstantModes& constants,
                                 const Eigen::MatrixXd& signals, const Eigen::Array2d& total,
                                 ShiftedCholesky& cholesky) {
    const double omega = 2.0 * kPi / octaves.featureSize(bundle.octave);
    cholesky.factorize(laplacian, omega * omega);
    KrylovSpaces spaces(cholesky, laplacian.D, constants, signals);

    const auto count = static_cast<Index>(bundle.thirds.size());
    Eigen::ArrayXd negligible(1 + 2 * count), relative(1 + 2 * count);
    negligible << kNegligible * total[0], Eigen::ArrayXd::Constant(count, kNegligible * total[0]),
        Eigen::ArrayXd::Constant(count, kNegligible * total[1]);
    relative << kConverged, Eigen::ArrayXd::Constant(2 * count, kThirdsConverged);
    Eigen::ArrayXd energies = Eigen::ArrayXd::Zero(1 + 2 * count), change = energies;
    for (int m = 1; m <= kMaxDimension; ++m) {
        if (!spaces.extend()) return energiesOf(bundle, octaves, thirds, spaces);
        if (m % kCheckInterval != 0) continue;
        const Eigen::ArrayXd before = energies, changeBefore = change;
        energies = energiesOf(bundle, octaves, thirds, spaces);
        change = (energies - before).abs();
        // One small change may be chance.
        if (m >= kFirstCheck &&
            (change.max(changeBefore) <= (relative * energies).max(negligible)).all())
            break;
    }
    return energies;
}

}  // namespace

BandEnergies energiesBeyond(const Bands& octaves, const Bands& thirds, const Laplacian& laplacian,
                            const ConstantModes& constants, double lastOfBasis,
                            const Eigen::MatrixXd& shape, const Eigen::VectorXd& noise,
                            ShiftedCholesky& cholesky, const Progress& progress) {
    Eigen::MatrixXd signals(shape.rows(), shape.cols() + 1);
    signals << shape, noise;
    const Eigen::Array2d total(shape.rowwise().squaredNorm().dot(laplacian.D),
                               noise.cwiseAbs2().dot(laplacian.D));

    BandEnergies beyond{Eigen::VectorXd::Zero(octaves.count()),
                        Eigen::VectorXd::Zero(thirds.count()),
                        Eigen::VectorXd::Zero(thirds.count())};
    const std::vector<Bundle> all = bundles(octaves, thirds, lastOfBasis);
    for (std::size_t i = 0; i < all.size(); ++i) {
        progress.report(static_cast<double>(i) / static_cast<double>(all.size()),
                        "energies of the octaves");
        const Eigen::ArrayXd energies = convergedEnergies(all[i], octaves, thirds, laplacian,
                                                          constants, signals, total, cholesky);
        const auto count = static_cast<Index>(all[i].thirds.size());
        beyond.octaves[all[i].octave] = energies[0];
        for (Index t = 0; t < count; ++t) {
            beyond.thirds[all[i].thirds[t]] = energies[1 + t];
            beyond.noise[all[i].thirds[t]] = energies[1 + count + t];
        }
    }
    return beyond;
}

}  // namespace spectral
