#include "core/noise/scan_lines.h"

#include <cmath>
#include <utility>

#include "core/graph/diffusion.h"
#include "core/graph/robust_statistics.h"
#include "core/noise/noise_estimate.h"

namespace spectral {

namespace {

/// The length that a fifth of the edges do not exceed.
double shortEdge(const VertexGraph& graph, const Points& X) {
    constexpr double kShortShare = 0.2;
    std::vector<double> lengths;
    for (Index i = 0; i < graph.size(); ++i)
        for (Index k = graph.first[i]; k < graph.first[i + 1]; ++k)
            if (graph.at[k] > i) lengths.push_back((X.row(graph.at[k]) - X.row(i)).norm());
    return quantile(std::move(lengths), kShortShare);
}

}  // namespace

WeightedResiduals weightedResiduals(const FaceGraph& graph, const Points& X,
                                    const std::vector<bool>& isMeasured) {
    constexpr double kPower = 2.0;
    const VertexGraph weighted = weightedByLength(graph.vertices, X, kPower);
    Eigen::VectorXd residual = scaledResiduals(weighted, X, smoothVertexNormals(graph, X));
    std::vector<double> moduli;
    for (Index i = 0; i < X.rows(); ++i) {
        if (!isMeasured[i]) residual[i] = 0.0;
        if (isMeasured[i]) moduli.push_back(std::abs(residual[i]));
    }
    WeightedResiduals result;
    result.deviation = medianDeviation(std::move(moduli));
    const double limit = kResidualClip * result.deviation;
    residual = residual.cwiseMax(-limit).cwiseMin(limit);
    Eigen::VectorXd means = Eigen::VectorXd::Zero(X.rows());
    forEachMean(weighted, residual, [&](Index i, const auto& mean) { means[i] = mean[0]; });
    if (limit > 0.0) result.correlation = residual.dot(means) / residual.squaredNorm();
    return result;
}

std::optional<ScanLineNoise> scanLineNoise(const FaceGraph& graph, const Points& X,
                                           const std::vector<bool>& isMeasured) {
    // Surfaces scanned in lines have less; clean statues and machine parts have more.
    constexpr double kMaxCorrelationOfLines = -0.2;
    const WeightedResiduals residuals = weightedResiduals(graph, X, isMeasured);
    const ScanLineNoise noise{residuals.deviation, shortEdge(graph.vertices, X)};
    if (!(noise.height > kMinHeight * noise.edge && residuals.correlation < kMaxCorrelationOfLines))
        return std::nullopt;
    return noise;
}

}  // namespace spectral
