#include "core/noise/stretched_axis.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/graph/robust_statistics.h"

namespace spectral {

double medianSlope(const Faces& F, const Points& X, int axis) {
    const Points N = areaNormals(X, F);
    std::vector<double> cosine;
    for (Index f = 0; f < N.rows(); ++f) {
        const double length = N.row(f).norm();
        if (length > 0.0) cosine.push_back(std::abs(N(f, axis)) / length);
    }
    if (cosine.empty()) return 0.0;
    const double c = quantile(std::move(cosine), 0.5);
    return std::sqrt(std::max(0.0, 1.0 - c * c)) / c;
}

std::optional<int> stretchedAxis(const Faces& F, const Points& X) {
    // Degrees for metres stretch a slope of 1 in 1000 to 100. A tower's walls are steep, too, but
    // seen from above their triangles are slivers.
    constexpr double kMinSlope = 10.0;   // median
    constexpr double kMinUpright = 0.9;  // area that faces one side, seen along the axis
    const Points N = areaNormals(X, F);
    for (int axis = 0; axis < 3; ++axis) {
        if (medianSlope(F, X, axis) < kMinSlope) continue;
        const double sum = std::abs(N.col(axis).sum()), all = N.col(axis).cwiseAbs().sum();
        if (!(sum > kMinUpright * all)) continue;
        Points seen = X;
        seen.col(axis).setZero();
        if (quantile(triangleQuality(F, seen), 0.5) > kNeedleQuality) return axis;
    }
    return std::nullopt;
}

}  // namespace spectral
