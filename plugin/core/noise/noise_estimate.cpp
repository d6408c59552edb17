#include "core/noise/noise_estimate.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "core/graph/diffusion.h"
#include "core/graph/local_average.h"
#include "core/graph/robust_statistics.h"
#include "core/noise/least_height.h"

namespace spectral {

namespace {

constexpr int kOctaves = 7;
using Octaves = Eigen::Array<double, kOctaves, 1>;

/// The standard deviation of the probes at the measured vertices.
template <int kProbes>
double deviationOfProbes(const Probed<kProbes>& rows, const std::vector<bool>& isMeasured) {
    double squares = 0.0, count = 0.0;
    for (Index i = 0; i < rows.rows(); ++i) {
        if (!isMeasured[i]) continue;
        squares += rows.row(i).template tail<kProbes>().squaredNorm();
        count += kProbes;
    }
    return count > 0.0 ? std::sqrt(squares / count) : 0.0;
}

template <int kProbes>
void visitOctaves(const VertexGraph& graph, const Points& X, const Points& N,
                  const std::vector<bool>& isMeasured, int count, const OctaveVisitor& visit) {
    Probed<kProbes> Y = withProbes<kProbes>(X);
    int power = 0;
    for (int k = 0; k < count; ++k) {
        const Probed<kProbes> before = Y;
        for (const int end = 1 << k; power < end; ++power) diffuse(graph, Y);
        const Probed<kProbes> octave = before - Y;
        visit(k, octave.template leftCols<3>().cwiseProduct(N).rowwise().sum(),
              deviationOfProbes<kProbes>(octave, isMeasured));
    }
}

/// The moduli of the measured values.
std::vector<double> moduliOf(const Eigen::VectorXd& values, const std::vector<bool>& isMeasured) {
    std::vector<double> moduli;
    for (Index i = 0; i < values.size(); ++i)
        if (isMeasured[i]) moduli.push_back(std::abs(values[i]));
    return moduli;
}

/// Correlation between neighbours of values clipped at two deviations; 1 if all vanish.
double correlationOfNeighbours(const VertexGraph& graph, Eigen::VectorXd values,
                               const std::vector<bool>& isMeasured) {
    const double limit = kResidualClip * medianDeviation(moduliOf(values, isMeasured));
    if (!(limit > 0.0)) return 1.0;
    values = values.cwiseMax(-limit).cwiseMin(limit);
    double products = 0.0, squares = 0.0;
    for (Index i = 0; i < values.size(); ++i)
        for (Index k = graph.first[i]; k < graph.first[i + 1]; ++k) {
            const int j = graph.at[k];
            if (!isMeasured[i] || !isMeasured[j]) continue;
            products += values[i] * values[j];
            squares += values[i] * values[i];
        }
    return squares > 0.0 ? products / squares : 1.0;
}

/// Correlation of second residuals along the direction in which neighbours are most alike, such as
/// the crests of ribs, threads and layers, in the median over the places: that of noise, which has
/// no direction, is -.3.
double correlationAlongCrests(const FaceGraph& graph, const Points& X, const Points& N,
                              std::vector<bool> isMeasured) {
    constexpr int kPlace = 16;
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, 7, Eigen::RowMajor>;
    Eigen::VectorXd second = scaledSecondResiduals(graph, X, N, isMeasured);
    const double limit = kResidualClip * medianDeviation(moduliOf(second, isMeasured));
    second = second.cwiseMax(-limit).cwiseMin(limit);
    const VertexGraph& vertices = graph.vertices;
    Rows rows = Rows::Zero(X.rows(), 7);  // products by direction, and squares
    parallelRows(X.rows(), [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i)
            for (Index k = vertices.first[i]; k < vertices.first[i + 1]; ++k) {
                const int j = vertices.at[k];
                if (!isMeasured[i] || !isMeasured[j]) continue;
                const Eigen::RowVector3d d = (X.row(j) - X.row(i)).normalized();
                const double product = second[i] * second[j];
                rows.row(i).head<3>() += product * d.cwiseAbs2();
                rows.row(i).segment<3>(3) +=
                    product * Eigen::RowVector3d(d[0] * d[1], d[0] * d[2], d[1] * d[2]);
                rows(i, 6) += 0.5 * second[i] * second[i];
            }
    });
    rows = LocalAverage(vertices, isMeasured, kPlace).of(std::move(rows));
    std::vector<double> along;
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
    for (Index i = 0; i < X.rows(); ++i) {
        if (!isMeasured[i] || !(rows(i, 6) > 0.0)) continue;
        Eigen::Matrix3d products;
        products << rows(i, 0), rows(i, 3), rows(i, 4), rows(i, 3), rows(i, 1), rows(i, 5),
            rows(i, 4), rows(i, 5), rows(i, 2);
        eigen.computeDirect(products, Eigen::EigenvaluesOnly);
        along.push_back((eigen.eigenvalues()[1] + eigen.eigenvalues()[2]) / rows(i, 6));
    }
    return quantile(std::move(along), 0.5);
}

/// The half of the measured vertices around which, averaged over so many steps, the given octave of
/// the shape has least energy.
std::vector<bool> quietest(const VertexGraph& graph, const Eigen::VectorXd& octave, int steps,
                           std::vector<bool> isMeasured) {
    constexpr double kQuietShare = 0.5;
    Eigen::VectorXd energy = octave.cwiseAbs2();
    for (int k = 0; k < steps; ++k) diffuse(graph, energy);
    const double limit = quantile(moduliOf(energy, isMeasured), kQuietShare);
    for (Index i = 0; i < energy.size(); ++i) isMeasured[i] = isMeasured[i] && energy[i] <= limit;
    return isMeasured;
}

/// The octaves of the shape along its normals, and standard deviations: theirs, and of white noise.
struct OctaveDeviations {
    std::array<Eigen::VectorXd, kOctaves> along;
    Octaves shape, white;
};

/// @param count  of the octaves, 4 or more; the others are 0.
OctaveDeviations octaveDeviations(const FaceGraph& graph, const Points& X, const Points& N,
                                  const std::vector<bool>& isMeasured, int count = kOctaves) {
    constexpr int kShapeOctave = 3, kQuietSteps = 16;
    OctaveDeviations deviations{{}, Octaves::Zero(), Octaves::Zero()};
    auto& along = deviations.along;
    forEachOctave(graph.vertices, X, N, isMeasured, count,
                  [&](int k, Eigen::VectorXd values, double white) {
                      along[k] = std::move(values);
                      deviations.white[k] = white;
                  });
    const std::vector<bool> isQuiet =
        quietest(graph.vertices, along[kShapeOctave], kQuietSteps, isMeasured);
    parallelFor(count, [&](Index k) {
        deviations.shape[k] = trimmedDeviation(moduliOf(along[k], isQuiet));
    });
    return deviations;
}

/// The largest part of each octave that the shape can explain. A shape rises by a factor from
/// octave to octave, so the coarser octaves, where it dominates, bound the finer ones.
/// @param height  deviations relative to those of white noise.
Octaves shapePart(const Octaves& height) {
    constexpr double kMaxRiseOfShape = 3.0;
    double rise = 0.0;
    for (int k = 2; k + 1 < kOctaves; ++k)
        if (height[k] > 0.0) rise = std::max(rise, height[k + 1] / height[k]);
    rise = std::clamp(rise, kRiseOfShape, kMaxRiseOfShape);
    Octaves shape = height;
    for (int k = kOctaves - 2; k >= 0; --k) shape[k] = std::min(height[k], shape[k + 1] / rise);
    return shape;
}

/// Fourth moment over the squared second one of measured values in units of their places, given by
/// their squares and the averages of these over the places: 3 for noise of any height, less where
/// crests have one height, more where most of a place is flatter than its creases.
double kurtosis(const Eigen::VectorXd& squares, const Eigen::VectorXd& place,
                const std::vector<bool>& isMeasured) {
    double second = 0.0, fourth = 0.0, count = 0.0;
    for (Index i = 0; i < squares.size(); ++i) {
        if (!isMeasured[i] || !(place[i] > 0.0)) continue;
        const double square = squares[i] / place[i];
        second += square;
        fourth += square * square;
        count += 1.0;
    }
    return second > 0.0 ? count * fourth / (second * second) : 3.0;
}

/// How an octave is distributed.
struct Distribution {
    double unevenness;  ///< Of its height: 95 % quantile of the places over the median.
    double kurtosis;    ///< Within the places.
};

Distribution distributionOf(const VertexGraph& graph, const Eigen::VectorXd& octave,
                            const std::vector<bool>& isMeasured) {
    constexpr int kPlace = 32;
    const Eigen::VectorXd squares = octave.cwiseAbs2();
    const Eigen::VectorXd place = LocalAverage(graph, isMeasured, kPlace).of(squares);
    const std::vector<double> places = moduliOf(place, isMeasured);
    return {std::sqrt(quantile(places, 0.95) / quantile(places, 0.5)),
            kurtosis(squares, place, isMeasured)};
}

/// Whether an octave longer than white noise is relief, such as ribs, waves, threads or knurls: it
/// has crests of like height, where noise has a normal distribution.
/// @param white  height of the white noise.
bool areCrestsAlike(const VertexGraph& graph, const OctaveDeviations& octaves, int octave,
                    double height, double white, const std::vector<bool>& isMeasured) {
    // Excess kurtosis less the white noise in it: at most -.6 with knurls, the least of reliefs,
    // and -.38 and more with noise over two edges.
    constexpr double kMaxExcess = -0.5;
    constexpr int kPlace = 64, kShapeOctave = 5;
    const double relief = 1.0 - std::pow(white / height, 2);
    if (!(relief > 0.0)) return false;
    const Eigen::VectorXd squares = octaves.along[octave].cwiseAbs2();
    const Eigen::VectorXd place = LocalAverage(graph, isMeasured, kPlace).of(squares);
    return kurtosis(squares, place,
                    quietest(graph, octaves.along[kShapeOctave], kPlace, isMeasured)) -
               3.0 <
           kMaxExcess * relief * relief;
}

/// The octave of relief on a flat part: they rise to it and fall again, which noise on a shape does
/// not. At the end they have .8 of it on sheets with ribs, waves or threads at the most, and 1 or
/// more on machine parts.
std::optional<int> octaveOfCrests(const Octaves& height) {
    constexpr double kMinRise = 1.25, kMaxEnd = 0.8;
    int crest = 0;
    const double highest = height.maxCoeff(&crest);
    if (crest < 2 || highest < kMinRise * height[0] || height[kOctaves - 1] > kMaxEnd * highest)
        return std::nullopt;
    return crest;
}

/// Whether the octaves rise alike, as on natural ground: there is neither a size that noise ends at
/// nor a shape under it. The rise is at most 2.25 on fractal ground, 1.43 at least; a shape under
/// scanner noise reaches 2.3 and more, noise on a flat part ends with 1.3 and less.
bool isSelfSimilar(const Octaves& height) {
    constexpr double kLeast = 1.4, kMost = 2.27;
    for (int k = 2; k + 1 < kOctaves; ++k)
        if (const double rise = height[k + 1] / height[k]; !(rise > kLeast && rise < kMost))
            return false;
    return true;
}

/// Diffusion powers in the middle of each octave; their roots are lengths in edges.
constexpr std::array<double, kOctaves> kPowers{0.5, 1.5, 3.0, 6.0, 12.0, 24.0, 48.0};
/// Octaves in which white noise defines the length 1: the coarser ones have too little.
constexpr int kWhiteOctaves = 5;

/// Largest rise of noise from an octave to the next coarser one.
constexpr double kMaxRiseOfNoise = 2.03;

/// Mean length, in edges, of a signal with these energies, over its first octaves.
double meanLength(const Octaves& energy, int octaves) {
    double lengths = 0.0, energies = 0.0;
    for (int k = 0; k < octaves; ++k) {
        lengths += energy[k] * std::sqrt(kPowers[k]);
        energies += energy[k];
    }
    return lengths / energies;
}

}  // namespace

Points smoothVertexNormals(const FaceGraph& graph, const Points& X, int blurs) {
    return vertexNormals(graph, blurredNormals(graph, areaNormals(X, graph.F), blurs));
}

Eigen::VectorXd scaledResiduals(const VertexGraph& graph, const Points& X, const Points& N) {
    Eigen::VectorXd residual = Eigen::VectorXd::Zero(X.rows());
    forEachMean(graph, X, [&](Index i, const Eigen::RowVector3d& mean) {
        double squares = 0.0;  // of the weights
        if (graph.weight.empty())
            squares = 1.0 / static_cast<double>(graph.degree(i));
        else
            for (Index k = graph.first[i]; k < graph.first[i + 1]; ++k)
                squares += graph.weight[k] * graph.weight[k];
        residual[i] = (X.row(i) - mean).dot(N.row(i)) / std::sqrt(1.0 + squares);
    });
    return residual;
}

void forEachOctave(const VertexGraph& graph, const Points& X, const Points& N,
                   const std::vector<bool>& isMeasured, int count, const OctaveVisitor& visit) {
    // On few vertices one draw says too little: some 7 % of the height of the last octave on
    // 15,000. With five, a row is a line of the cache.
    constexpr Index kMany = 50000;
    if (X.rows() < kMany)
        visitOctaves<5>(graph, X, N, isMeasured, count, visit);
    else
        visitOctaves<1>(graph, X, N, isMeasured, count, visit);
}

double residualCorrelation(const FaceGraph& graph, const Points& X, const Points& N,
                           const std::vector<bool>& isMeasured) {
    return correlationOfNeighbours(graph.vertices, scaledResiduals(graph.vertices, X, N),
                                   isMeasured);
}

bool SecondResiduals::isNoise(double firstCorrelation, double meanEdge) const {
    // Rough stone, decimated, is white noise of .045 edges; on steep ground there are .072.
    constexpr double kWeakHeight = 0.06;
    // At least -.22 on fractal ground and on all decimated shapes but that; -.26 and less with
    // white noise on any shape.
    constexpr double kMaxCorrelation = -0.24;
    return correlation < kMaxCorrelation &&
           (firstCorrelation < 0.0 || height > kWeakHeight * meanEdge);
}

Eigen::VectorXd scaledSecondResiduals(const FaceGraph& graph, const Points& X, const Points& N,
                                      std::vector<bool>& isMeasured) {
    const VertexGraph& vertices = graph.vertices;
    const std::vector<bool> wasMeasured(isMeasured);
    for (Index i = 0; i < vertices.size(); ++i)
        for (Index k = vertices.first[i]; k < vertices.first[i + 1]; ++k)
            isMeasured[i] = isMeasured[i] && wasMeasured[vertices.at[k]];
    Probed<1> residual = withProbes<1>(X);
    for (int k = 0; k < 2; ++k) {
        Probed<1> next = Probed<1>::Zero(X.rows(), 4);
        forEachMean(vertices, residual,
                    [&](Index i, const auto& mean) { next.row(i) = residual.row(i) - mean; });
        residual.swap(next);
    }
    const double white = deviationOfProbes<1>(residual, isMeasured);
    return residual.leftCols<3>().cwiseProduct(N).rowwise().sum() / (white > 0.0 ? white : 1.0);
}

SecondResiduals secondResiduals(const FaceGraph& graph, const Points& X, const Points& N,
                                std::vector<bool> isMeasured) {
    const Eigen::VectorXd residual = scaledSecondResiduals(graph, X, N, isMeasured);
    return {trimmedDeviation(moduliOf(residual, isMeasured)),
            correlationOfNeighbours(graph.vertices, residual, isMeasured)};
}

bool isOtherNoise(const FaceGraph& graph, const Points& X, const Points& N,
                  const std::vector<bool>& isMeasured, double first, double second) {
    // Of neighbours' second residuals: -.19 and less in volumes, -.16 and -.12 to -.13 on decimated
    // shapes, -.1 and more with data coarser than the mesh. Of first ones: .23 and less in volumes,
    // .29 on a subdivided statue, whose facets are as noise is.
    constexpr double kMaxSecondOfVolume = -0.17, kMaxFirstOfVolume = 0.25;
    constexpr double kMinSecondOfCoarser = -0.105;
    const bool isVolume = second < kMaxSecondOfVolume && first < kMaxFirstOfVolume;
    if (!isVolume && !(second > kMinSecondOfCoarser)) return false;
    const int octave = isVolume ? 0 : 1;  // beyond it, a shape hides the noise of volumes
    const OctaveDeviations octaves = octaveDeviations(graph, X, N, isMeasured, 4);
    const Octaves height = (octaves.white > 0.0).select(octaves.shape / octaves.white, 0.0);
    if (!(height[octave + 1] < kMaxRiseOfNoise * height[octave])) return false;
    // Unevenness: 1.45 on a machine part subdivided, 1.54 on one with white noise, which is weak in
    // the flat. Kurtosis: 2.79 where meshes were subdivided by Loop's rule, 2.75 on a decimated
    // statue and 2.73 on knurls with white noise.
    constexpr double kMaxUnevenness = 1.5, kMinKurtosis = 2.77;
    const auto [unevenness, kurtosis] =
        distributionOf(graph.vertices, octaves.along[octave], isMeasured);
    return unevenness < kMaxUnevenness && kurtosis > kMinKurtosis;
}

NoiseEstimate estimateNoise(const FaceGraph& graph, const Points& X, const Points& N,
                            const std::vector<bool>& isMeasured, double correlation,
                            const SecondResiduals& second, bool isOther, double meanEdge) {
    constexpr double kMinNoiseShare = 0.45;  // share of an octave that must be noise
    // Height over the part of it that the shape does not hide, for noise of 1.5 edges.
    constexpr double kHiddenHeight = 1.3;
    const OctaveDeviations octaves = octaveDeviations(graph, X, N, isMeasured);
    const auto& [along, deviation, white] = octaves;
    const Octaves height = (white > 0.0).select(deviation / white, 0.0);
    const Octaves noise = (height.square() - shapePart(height).square()).max(0.0).sqrt();

    Octaves energy = Octaves::Zero();
    for (int k = 0; k < kOctaves; ++k) {
        const int finer = std::max(k - 1, 0);
        if (!(noise[k] >= kMinNoiseShare * height[k] &&
              height[finer + 1] < kMaxRiseOfNoise * height[finer]))
            break;
        energy[k] = std::pow(noise[k] * white[k], 2);
    }
    NoiseEstimate estimate;
    estimate.meanEdge = meanEdge;
    if (energy.sum() > 0.0) {
        const double length =
            meanLength(energy, kOctaves) / meanLength(white.square(), kWhiteOctaves);
        estimate.size = std::max(1.0, length);
        estimate.height = kHiddenHeight * std::sqrt(energy.sum() / white.square().sum());
        estimate.isShape = estimate.size > 1.0 && isSelfSimilar(height);
    }
    // White noise is measured best in the first octave, which has least of the shape, or beyond it.
    constexpr double kMinSize = 1.22, kMaxWhiteCorrelation = -0.1;
    constexpr int kLongerThanWhite = 2;
    const bool isLong = estimate.size >= kMinSize && correlation >= kMaxWhiteCorrelation;
    const std::optional<int> crests =
        isLong ? std::optional<int>(kLongerThanWhite) : octaveOfCrests(height);
    // It is the same in all octaves, so that what falls is relief of a few edges: to .66 and less
    // with reliefs of four edges, to .76 with impulses, .9 and more with other noise.
    // Without noise it falls to .39 and less, with noise of .2 edges to .51 and more.
    constexpr double kMinOfNoise = 0.7, kMaxOfRelief = 0.5;
    const double lowest = crests ? height.minCoeff() : height.head<kWhiteOctaves>().minCoeff();
    const bool isShort = lowest < kMinOfNoise * height[0];
    const bool isRelief =
        isShort || (crests && areCrestsAlike(graph.vertices, octaves, *crests, height[*crests],
                                             second.height, isMeasured));
    estimate.isUnderShape =
        (correlation >= kMaxPureNoise && second.isNoise(correlation, meanEdge)) || isRelief;
    if (estimate.isUnderShape || !isLong) {
        estimate.size = 1.0;
        // A shape adds to both; creases more to the second residuals.
        estimate.height = estimate.isUnderShape
                              ? leastHeight(graph, X, N, isMeasured, second.height)
                              : std::min(second.height, noise[0]);
        if (isShort) estimate.height = std::min(estimate.height, lowest);
        // Vertices near to each other on the edges of a grid have like noise, so that it rises.
        estimate.isEven = isOther && !estimate.isUnderShape && noise[1] > estimate.height;
        if (estimate.isEven) estimate.height = noise[1];
    }
    // Of second residuals along crests: at least -.22 on clean ribs of six edges, which fall, and
    // -.1 on those of eight, which do not; -.25 and -.21 with noise of .1 edges on these.
    constexpr double kAlongFalling = -0.235, kAlong = -0.15;
    const bool mayBeShape = !isShort || lowest < kMaxOfRelief * height[0];
    if (estimate.isUnderShape && ((isShort && estimate.height < kMinHeight * meanEdge) ||
                                  (mayBeShape && correlationAlongCrests(graph, X, N, isMeasured) >
                                                     (isShort ? kAlongFalling : kAlong)))) {
        estimate.isShape = true;
        estimate.height = 0.0;
    }
    return estimate;
}

}  // namespace spectral
