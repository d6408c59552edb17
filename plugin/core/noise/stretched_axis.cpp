#include "core/noise/stretched_axis.h"

#include <cmath>
#include <vector>

#include "core/graph/robust_statistics.h"

namespace spectral {

std::optional<int> stretchedAxis(const FaceGraph& graph, const Points& X) {
    // Degrees for metres stretch a slope of 1 in 1000 to 100. A tower's walls are steep, too, but
    // seen from above their triangles are slivers.
    constexpr double kMinSlope = 10.0;   // median
    constexpr double kMinUpright = 0.9;  // area that faces one side, seen along the axis
    const Points N = areaNormals(X, graph.F);
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<double> cosine;
        for (Index f = 0; f < N.rows(); ++f) {
            const double length = N.row(f).norm();
            if (length > 0.0) cosine.push_back(std::abs(N(f, axis)) / length);
        }
        if (cosine.empty() || quantile(std::move(cosine), 0.5) > 1.0 / kMinSlope) continue;
        const double sum = std::abs(N.col(axis).sum()), all = N.col(axis).cwiseAbs().sum();
        if (!(sum > kMinUpright * all)) continue;
        Points seen = X;
        seen.col(axis).setZero();
        if (quantile(triangleQuality(graph, seen), 0.5) > kNeedleQuality) return axis;
    }
    return std::nullopt;
}

}  // namespace spectral
