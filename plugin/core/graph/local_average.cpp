#include "core/graph/local_average.h"

namespace spectral {

std::vector<double> diffusionCoefficients(int steps) {
    constexpr double kSmallest = 1e-4;
    double coefficient = 1.0;  // binomial(2 steps, steps) / 4^steps
    for (int j = 1; j <= steps; ++j) coefficient *= (2.0 * j - 1.0) / (2.0 * j);
    std::vector<double> coefficients{coefficient};
    double sum = coefficient;
    coefficient *= 2.0;
    for (int j = 1; j <= steps; ++j) {
        coefficient *= static_cast<double>(steps - j + 1) / static_cast<double>(steps + j);
        if (j > 1 && coefficient < kSmallest) break;
        coefficients.push_back(coefficient);
        sum += coefficient;
    }
    for (double& value : coefficients) value /= sum;  // constants are kept
    return coefficients;
}

LocalAverage::LocalAverage(const VertexGraph& graph, const std::vector<bool>& counts, int steps)
    : graph_(graph), counts_(counts), steps_(steps), weight_(graph.size()) {
    constexpr double kMinWeight = 1e-3;
    for (Index i = 0; i < graph.size(); ++i) weight_[i] = counts[i] ? 1.0 : 0.0;
    if (weight_.minCoeff() < 1.0) diffuseFast(graph, steps, weight_);
    weight_ = weight_.cwiseMax(kMinWeight);
}

}  // namespace spectral
