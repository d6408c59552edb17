#include "core/denoise/whiteness.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/graph/diffusion.h"
#include "core/graph/robust_statistics.h"
#include "core/noise/noise_estimate.h"

namespace spectral {

namespace {

double deviation(const Eigen::VectorXd& y) {
    return std::sqrt((y.array() - y.mean()).square().mean());
}

}  // namespace

Eigen::VectorXd displacementAlongNormals(const FaceGraph& graph, const Points& X0,
                                         const Points& X) {
    return (X - X0).cwiseProduct(smoothVertexNormals(graph, X, 1)).rowwise().sum();
}

double smoothness(const VertexGraph& graph, const Eigen::VectorXd& signal) {
    double white = 0.0;  // variance that one step leaves of white noise of variance 1
    for (Index i = 0; i < graph.size(); ++i)
        white += graph.degree(i) > 0 ? 0.25 + 0.25 / static_cast<double>(graph.degree(i)) : 1.0;
    white = std::sqrt(white / static_cast<double>(graph.size()));
    Eigen::VectorXd y = signal;
    diffuse(graph, y);
    const double before = deviation(signal);
    return before > 0.0 ? deviation(y) / before / white : 1.0;
}

double tail(const VertexGraph& graph, const Eigen::VectorXd& signal) {
    constexpr double kTailShare = 0.99, kNormalTail = 2.5758;  // normal distribution
    Eigen::VectorXd y = signal;
    double largest = 0.0;
    int step = 0;
    for (const int end : {1, 2, 4}) {
        for (; step < end; ++step) diffuse(graph, y);
        const double mean = y.mean();
        std::vector<double> moduli(y.begin(), y.end());
        for (double& value : moduli) value = std::abs(value - mean);
        largest =
            std::max(largest, quantile(std::move(moduli), kTailShare) / deviation(y) / kNormalTail);
    }
    return largest;
}

}  // namespace spectral
