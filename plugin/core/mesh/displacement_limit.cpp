#include "core/mesh/displacement_limit.h"

#include <algorithm>
#include <cmath>

namespace spectral {

namespace {

/// The least value at each vertex and those it shares a triangle with.
Eigen::VectorXd leastAround(const Faces& F, const Eigen::VectorXd& values) {
    Eigen::VectorXd least = values;
    for (Index t = 0; t < F.rows(); ++t) {
        const double one = std::min({values[F(t, 0)], values[F(t, 1)], values[F(t, 2)]});
        for (const int i : F.row(t)) least[i] = std::min(least[i], one);
    }
    return least;
}

/// Means over the triangles of each vertex, of the means over their corners.
Eigen::VectorXd meanAround(const Faces& F, const Eigen::VectorXd& values) {
    Eigen::VectorXd sums = Eigen::VectorXd::Zero(values.size());
    Eigen::VectorXd counts = Eigen::VectorXd::Zero(values.size());
    for (Index t = 0; t < F.rows(); ++t) {
        const double mean = (values[F(t, 0)] + values[F(t, 1)] + values[F(t, 2)]) / 3.0;
        for (const int i : F.row(t)) {
            sums[i] += mean;
            counts[i] += 1.0;
        }
    }
    return (counts.array() > 0.0).select(sums.array() / counts.array().max(1.0), values.array());
}

}  // namespace

double limitDisplacement(const Faces& F, const Eigen::VectorXd& areas, double bound, int rings,
                         Vertices& displacement) {
    // Hosts pass lengths in single precision, which may have rounded it up.
    constexpr double kRounding = 6e-8;
    if (bound <= 0.0) return 0.0;
    bound *= 1.0 - kRounding;
    const Eigen::VectorXd lengths = displacement.rowwise().norm();
    const auto isLonger = lengths.array() > bound;
    if (!isLonger.any()) return 0.0;
    const Eigen::VectorXd most = isLonger.select(bound / lengths.array(), 1.0);
    Eigen::VectorXd strength = most;
    for (int ring = 0; ring < rings; ++ring) strength = leastAround(F, strength);
    for (int ring = 0; ring < rings; ++ring) strength = meanAround(F, strength);
    displacement = strength.cwiseMin(most).asDiagonal() * displacement;
    return isLonger.select(areas.array(), 0.0).sum() / areas.sum();
}

int ringsWithin(double edges) { return static_cast<int>(std::clamp(std::ceil(edges), 4.0, 64.0)); }

}  // namespace spectral
