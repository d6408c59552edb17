#include "core/analysis/spectral_measure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/support/threads.h"

namespace spectral {

namespace {

double energyIn(const Bands& bands, int j, const Quadrature& measure) {
    double energy = 0.0;
    for (Index i = 0; i < measure.omega.size(); ++i)
        energy += measure.weight[i] * bands.window(j, measure.omega[i]);
    return energy;
}

/// Error of S relative to its norm: round-off, amplified by long recurrences.
constexpr double kRoundOff = 1e-10;

/// The nodes of both quadratures.
Quadrature operator+(const Quadrature& one, const Quadrature& other) {
    const Index a = one.omega.size(), b = other.omega.size();
    Quadrature sum{Eigen::VectorXd(a + b), Eigen::VectorXd(a + b)};
    sum.omega << one.omega, other.omega;
    sum.weight << one.weight, other.weight;
    return sum;
}

/// Narrows the range of frequencies to that resolved by the nodes of one column.
///
/// At an unresolved end, the last node stands for all harmonics beyond it, although its energy
/// changes as little as that of a single harmonic. It is recognized because it moves as the space
/// grows, or because it is far from the frequency that is resolved best.
void narrow(Eigen::VectorXd smaller, Eigen::VectorXd larger, double best, MeasureInSpace& space) {
    constexpr double kMaxMove = 0.01;  // relative change of a frequency
    constexpr double kFar = 16.0;      // ratio of two frequencies
    constexpr Index kUnresolved = 4;   // nodes to discard near an unresolved end
    if (smaller.size() <= kUnresolved) return;
    std::sort(smaller.begin(), smaller.end());
    std::sort(larger.begin(), larger.end());
    const auto isResolved = [&](double before, double now) {
        return std::abs(now - before) <= kMaxMove * now && now >= best / kFar && now <= best * kFar;
    };
    const Index last = larger.size() - 1;
    if (!isResolved(smaller[0], larger[0])) space.from = std::max(space.from, larger[kUnresolved]);
    if (!isResolved(smaller[smaller.size() - 1], larger[last]))
        space.to = std::min(space.to, larger[last - kUnresolved]);
}

}  // namespace

BandEnergy SpectralMeasure::in(const Bands& bands, int j) const {
    const double centre = 2.0 * kPi / bands.featureSize(j);
    BandEnergy best;
    double least = std::numeric_limits<double>::infinity();
    for (const MeasureInSpace& space : spaces_) {
        const double energy = energyIn(bands, j, space.larger);
        if (!(energy > 0.0)) continue;
        const double change = std::abs(energy - energyIn(bands, j, space.smaller)) / energy;
        const bool isResolved = centre >= space.from && centre <= space.to;
        const double rank = isResolved ? change : 1.0 + change;
        if (rank >= least) continue;
        least = rank;
        best = {energy, isResolved ? change * energy : energy};
    }
    best.energy += energyIn(bands, j, exact_);
    return best;
}

Quadrature SpectralMeasure::first() const {
    return spaces_.empty() ? exact_ : exact_ + spaces_.front().larger;
}

Quadrature SpectralMeasure::last() const {
    return spaces_.empty() ? exact_ : exact_ + spaces_.back().larger;
}

void addMeasures(const KrylovOperator& S, const Laplacian& laplacian,
                 const Eigen::MatrixXd& signals, int dimension, const Progress& progress,
                 ShapeAndNoise& measures) {
    KrylovSpaces spaces(S, laplacian, signals, KrylovSpaces::kOrthogonal, false);
    constexpr int kShape = 3, kSignals = kShape + 1;
    using Columns = std::array<Quadrature, kSignals>;
    const auto grow = [&](int begin, int end) {
        for (int m = begin; m < end; ++m) {
            progress.report(static_cast<double>(m) / dimension, "energies of the octaves");
            if (!spaces.extend()) break;
        }
        Columns columns;
        parallelFor(kSignals,
                    [&](Index c) { columns[c] = spaces.quadrature(static_cast<int>(c)); });
        return columns;
    };
    const int first = 2 * dimension / 3;
    const Columns smaller = grow(0, first), larger = grow(first, dimension);
    const double best = std::min(S.centralFrequency(), S.lastFrequency());
    const auto sumOf = [&](int begin, int end) {
        MeasureInSpace sum;
        sum.from = std::sqrt(S.lambda(S.theta(0.0) + S.errorOf(S.theta(0.0), kRoundOff)));
        for (int c = begin; c < end; ++c) {
            sum.smaller = sum.smaller + smaller[c];
            sum.larger = sum.larger + larger[c];
            narrow(smaller[c].omega, larger[c].omega, best, sum);
        }
        return sum;
    };
    measures.shape.add(sumOf(0, kShape));
    measures.noise.add(sumOf(kShape, kSignals));
}

}  // namespace spectral
