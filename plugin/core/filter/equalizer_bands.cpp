#include "core/filter/equalizer_bands.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/filter/full_spectrum_evaluator.h"
#include "core/laplacian/harmonic_extension.h"
#include "core/laplacian/laplacian_builder.h"
#include "core/mesh/contacts.h"
#include "core/mesh/measures.h"
#include "core/mesh/mesh_check.h"
#include "core/support/frequency.h"
#include "core/support/memory.h"
#include "core/support/threads.h"

namespace spectral {

namespace {

/// Cubic B-splines a quarter of an octave apart: the sum of the bands is off by 3 % of the
/// displacement where gains are above 0, and by up to 9 % where they fall to 0.
constexpr int kPerOctave = 4;

/// Share of the free memory that the bands may take.
constexpr double kShareOfMemory = 0.25;

/// Accuracy of a band, as a root mean square over the surface, in mean edges: not seen.
constexpr double kShareOfEdge = 0.005;
constexpr double kLoosest = 1e-3, kFinest = 1e-6;

/// The cubic B-spline of the knots -2, -1, 0, 1, 2.
double spline(double t) {
    const double x = std::abs(t);
    if (x >= 2.0) return 0.0;
    if (x >= 1.0) return (2.0 - x) * (2.0 - x) * (2.0 - x) / 6.0;
    return 2.0 / 3.0 - x * x + 0.5 * x * x * x;
}

/// The sum of all splines at 0, -1, -2, ...: 1 at the left, 0 at the right.
double lastSpline(double t) {
    if (t <= -1.0) return 1.0;
    double sum = 0.0;
    for (int k = 0; k < 4; ++k) sum += spline(t + k);
    return sum;
}

int bandCount(int octaves) { return kPerOctave * octaves + 2; }

/// Band j as a gain; the first has all finer details, too.
Gain bandGain(double highest, int j) {
    return [highest, j](double omega) {
        if (omega <= 0.0) return 0.0;
        const double below = kPerOctave * std::log2(highest / omega);
        return j == 0 ? lastSpline(below + 1.0) : spline(below - (j - 1));
    };
}

}  // namespace

double EqualizerBands::bytes(Index n, int octaves) {
    return static_cast<double>(sizeof(float)) * 3.0 * bandCount(octaves) * static_cast<double>(n);
}

EqualizerBands::EqualizerBands(const Vertices& V, const Faces& F, const BandOptions& options,
                               const Progress& progress)
    : surface_(joinedSurface(V, F)),
      components_(connectedComponents(surface_.F, surface_.X.rows())) {
    const ThreadTeam team(progress);
    const Vertices& X = surface_.X;
    // While they are computed, they are in double precision.
    requireMemory((3.0 / kShareOfMemory) * bytes(X.rows(), options.octaves), X.rows());
    checkWeights(options.part);
    const std::vector<bool> isFixed = fixedVerticesOf(surface_.F, X.rows(), options.boundary);
    keepFixed(isFixed, surface_);
    const Interior interior(components_, isFixed);
    const LaplacianBuilder laplacians(surface_, components_, LaplacianKind::IntrinsicDelaunay,
                                      BasisUpdate::Conformal);
    const Laplacian& whole = laplacians.current();
    requireUsable(whole);
    const double highest = cutoffFrequency(options.smallestSize);
    const Eigen::VectorXd weight =
        vertexWeight(options.part, surface_, interior, whole,
                     options.smallestSize * std::exp2(0.5 * options.octaves));
    for (int j = 0; j < bandCount(options.octaves); ++j)
        centres_.push_back(highest * std::exp2((1.0 - j) / kPerOctave));
    if (interior.size() == 0) return;

    const bool isWhole = interior.isWhole();
    Laplacian inside;
    Eigen::MatrixXd U = X;
    if (!isWhole) {
        inside = interior.restricted(whole);
        U = HarmonicExtension(interior).remainder(whole, inside, X).U;
    }
    const Laplacian& L = isWhole ? whole : inside;
    std::vector<Gain> gains;
    for (std::size_t j = 0; j < centres_.size(); ++j)
        gains.push_back(bandGain(highest, static_cast<int>(j)));

    FullSpectrumOptions evaluation;
    const double size = std::sqrt(U.rowwise().squaredNorm().mean());
    evaluation.accuracy =
        std::clamp(kShareOfEdge * meanEdgeLength(X, surface_.F) / size, kFinest, kLoosest);
    evaluation.atEveryVertex = false;
    constexpr int kSamplesPerOctave = 24;
    for (int i = -kSamplesPerOctave; i <= kSamplesPerOctave * (options.octaves + 2); ++i)
        evaluation.samples.push_back(highest *
                                     std::exp2(-static_cast<double>(i) / kSamplesPerOctave));
    std::sort(evaluation.samples.begin(), evaluation.samples.end());
    // The dimension grows with the distance from the pole: two halves with a pole each take .6 to
    // .7 of the time of one.
    ShiftedLdlt ldlt;
    const std::size_t half = (gains.size() + 1) / 2;
    for (std::size_t from = 0; from < gains.size(); from += half) {
        const std::size_t to = std::min(from + half, gains.size()), middle = (from + to) / 2;
        const auto share = [&](std::size_t i) {
            return static_cast<double>(i) / static_cast<double>(gains.size());
        };
        const Progress stage = progress.part(share(from), share(to));
        const double pole =
            selectPole(gains[middle], centres_[middle], bulkSpectrum(L), evaluation.accuracy);
        ldlt.factorizeDefinite(L.W, L.D, pole, [&] { stage.report(0.0, "factorizing"); });
        std::vector<Eigen::MatrixXd> Y =
            evaluateInKrylovSpaces(L, ldlt, {gains.begin() + from, gains.begin() + to}, U,
                                   evaluation, stage)
                .Y;
        for (Eigen::MatrixXd& band : Y) {
            L.constants.remove(L.D, band);  // which every gain keeps
            if (!isWhole) band = interior.extended(std::move(band));
            bands_.emplace_back((weight.asDiagonal() * band).cast<float>());
            band.resize(0, 0);
        }
    }
}

Vertices EqualizerBands::displacement(const Equalizer& gain) const {
    // Coefficients whose spline meets the gain at the centres, to fourth order.
    const auto at = [&](double omega) { return gain(omega) - 1.0; };
    const double step = std::exp2(1.0 / kPerOctave);
    Eigen::MatrixXf sum = Eigen::MatrixXf::Zero(surface_.X.rows(), 3);
    std::vector<std::pair<float, const Eigen::MatrixXf*>> terms;
    for (std::size_t j = 0; j < bands_.size(); ++j) {
        const double omega = centres_[j];
        const double factor = (8.0 * at(omega) - at(omega * step) - at(omega / step)) / 6.0;
        if (factor != 0.0) terms.emplace_back(static_cast<float>(factor), &bands_[j]);
    }
    parallelRows(sum.rows(), [&](Index begin, Index end) {
        for (const auto& [factor, band] : terms)
            sum.middleRows(begin, end - begin) += factor * band->middleRows(begin, end - begin);
    });
    Vertices displacement = sum.cast<double>();
    moveContactsAlike(surface_, components_, displacement);
    followEdges(surface_, displacement);
    return displacement;
}

}  // namespace spectral
