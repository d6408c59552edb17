#include "core/noise/noise_estimate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/graph/diffusion.h"
#include "core/graph/local_average.h"
#include "core/graph/robust_statistics.h"

namespace spectral {

namespace {

constexpr int kOctaves = 7;
using Octaves = Eigen::Array<double, kOctaves, 1>;

/// The standard deviation of the measured values.
double deviationOf(const Eigen::VectorXd& values, const std::vector<bool>& isMeasured) {
    double sum = 0.0, squares = 0.0, count = 0.0;
    for (Index i = 0; i < values.size(); ++i) {
        if (!isMeasured[i]) continue;
        sum += values[i];
        squares += values[i] * values[i];
        count += 1.0;
    }
    return count > 0.0 ? std::sqrt(std::max(0.0, squares / count - std::pow(sum / count, 2))) : 0.0;
}

/// The moduli of the measured values.
std::vector<double> moduliOf(const Eigen::VectorXd& values, const std::vector<bool>& isMeasured) {
    std::vector<double> moduli;
    for (Index i = 0; i < values.size(); ++i)
        if (isMeasured[i]) moduli.push_back(std::abs(values[i]));
    return moduli;
}

/// The half of the measured vertices around which the given octave of the shape has least energy.
std::vector<bool> quietest(const VertexGraph& graph, const Eigen::VectorXd& octave,
                           std::vector<bool> isMeasured) {
    constexpr double kQuietShare = 0.5;
    constexpr int kSteps = 16;
    Eigen::VectorXd energy = octave.cwiseAbs2();
    for (int k = 0; k < kSteps; ++k) diffuse(graph, energy);
    const double limit = quantile(moduliOf(energy, isMeasured), kQuietShare);
    for (Index i = 0; i < energy.size(); ++i) isMeasured[i] = isMeasured[i] && energy[i] <= limit;
    return isMeasured;
}

/// Standard deviations in each octave: of the shape along its normals, and of white noise.
struct OctaveDeviations {
    Octaves shape, white;
};

OctaveDeviations octaveDeviations(const FaceGraph& graph, const Points& X, const Points& N,
                                  const std::vector<bool>& isMeasured) {
    constexpr int kShapeOctave = 3;
    OctaveDeviations deviations;
    std::array<Eigen::VectorXd, kOctaves> along;
    forEachOctave(graph.vertices, X, N, isMeasured, kOctaves,
                  [&](int k, Eigen::VectorXd values, double white) {
                      along[k] = std::move(values);
                      deviations.white[k] = white;
                  });
    const std::vector<bool> isQuiet = quietest(graph.vertices, along[kShapeOctave], isMeasured);
    parallelFor(kOctaves, [&](Index k) {
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

/// Diffusion powers in the middle of each octave; their roots are lengths in edges.
constexpr std::array<double, kOctaves> kPowers{0.5, 1.5, 3.0, 6.0, 12.0, 24.0, 48.0};
/// Octaves in which white noise defines the length 1: the coarser ones have too little.
constexpr int kWhiteOctaves = 5;

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
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>;
    Rows Y(X.rows(), 4);  // positions and white noise
    Y << X, whiteNoise(X.rows());
    int power = 0;
    for (int k = 0; k < count; ++k) {
        const Rows before = Y;
        for (const int end = 1 << k; power < end; ++power) diffuse(graph, Y);
        const Rows octave = before - Y;
        visit(k, octave.leftCols<3>().cwiseProduct(N).rowwise().sum(),
              deviationOf(octave.col(3), isMeasured));
    }
}

double residualCorrelation(const FaceGraph& graph, const Points& X,
                           const std::vector<bool>& isMeasured, int shapeSteps) {
    const VertexGraph& vertices = graph.vertices;
    Eigen::VectorXd residual = scaledResiduals(vertices, X, smoothVertexNormals(graph, X));
    std::vector<double> moduli;
    for (Index i = 0; i < X.rows(); ++i)
        if (isMeasured[i]) moduli.push_back(std::abs(residual[i]));
    const double limit = kResidualClip * medianDeviation(std::move(moduli));
    if (!(limit > 0.0)) return 1.0;
    residual = residual.cwiseMax(-limit).cwiseMin(limit);
    if (shapeSteps > 0) residual -= LocalAverage(vertices, isMeasured, shapeSteps).of(residual);
    double products = 0.0, squares = 0.0;
    for (Index i = 0; i < X.rows(); ++i)
        for (Index k = vertices.first[i]; k < vertices.first[i + 1]; ++k) {
            const int j = vertices.at[k];
            if (!isMeasured[i] || !isMeasured[j]) continue;
            products += residual[i] * residual[j];
            squares += residual[i] * residual[i];
        }
    return squares > 0.0 ? products / squares : 1.0;
}

NoiseEstimate estimateNoise(const FaceGraph& graph, const Points& X,
                            const std::vector<bool>& isMeasured, double correlation,
                            double meanEdge) {
    constexpr double kMinNoiseShare = 0.45;   // share of an octave that must be noise
    constexpr double kMaxRiseOfNoise = 2.03;  // of noise, from an octave to the next coarser one
    // Height over the part of it that the shape does not hide, for noise of 1.5 edges.
    constexpr double kHiddenHeight = 1.3;
    const Points N = smoothVertexNormals(graph, X);
    const auto [deviation, white] = octaveDeviations(graph, X, N, isMeasured);
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
    if (!(energy.sum() > 0.0)) return estimate;
    const double length = meanLength(energy, kOctaves) / meanLength(white.square(), kWhiteOctaves);
    estimate.size = std::max(1.0, length);
    estimate.height = kHiddenHeight * std::sqrt(energy.sum() / white.square().sum());
    // White noise is measured best in the first octave, which has least of the shape.
    constexpr double kMinSize = 1.22, kMaxWhiteCorrelation = -0.1;
    if (estimate.size < kMinSize || correlation < kMaxWhiteCorrelation) {
        estimate.size = 1.0;
        estimate.height = noise[0];
    }
    return estimate;
}

}  // namespace spectral
