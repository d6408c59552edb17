#include "core/noise/voxel_lattice.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/support/threads.h"

namespace spectral {

namespace {

/// Half the size of a voxel along an axis, on multiples of which all coordinates lie, and these
/// multiples; a size of 0 if there is none.
struct HalfSteps {
    double size = 0.0;
    Eigen::VectorXi of;
};

HalfSteps halfSteps(const Eigen::VectorXd& coordinates) {
    constexpr double kEqual = 2e-5;        // of the extent: no difference
    constexpr double kVerticesOfStep = 8;  // at least, in the mean: a lattice is met often
    constexpr std::size_t kLeastSteps = 4;
    constexpr double kRounded = 0.02;     // of a half step
    constexpr double kMostBeside = 0.01;  // share of the vertices
    std::vector<double> sorted(coordinates.begin(), coordinates.end());
    std::sort(sorted.begin(), sorted.end());
    const double extent = sorted.back() - sorted.front();
    std::vector<double> differences;
    for (std::size_t i = 1; i < sorted.size(); ++i)
        if (sorted[i] - sorted[i - 1] > kEqual * extent)
            differences.push_back(sorted[i] - sorted[i - 1]);
    if (differences.size() < kLeastSteps ||
        kVerticesOfStep * static_cast<double>(differences.size()) >
            static_cast<double>(sorted.size()))
        return {};
    const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
    std::nth_element(differences.begin(), middle, differences.end());
    const Eigen::ArrayXd steps = (coordinates.array() - sorted.front()) / *middle;
    const Index beside = ((steps - steps.round()).abs() > kRounded).count();
    if (static_cast<double>(beside) > kMostBeside * static_cast<double>(sorted.size())) return {};
    return {*middle, steps.round().cast<int>()};
}

}  // namespace

std::optional<Eigen::RowVector3d> voxelLattice(const Points& X) {
    constexpr double kLeastShare = 0.97;
    HalfSteps axes[3];
    parallelFor(3, [&](Index c) { axes[c] = halfSteps(X.col(c)); });
    for (const HalfSteps& axis : axes)
        if (axis.size == 0.0) return std::nullopt;
    // Which multiples are whole numbers of voxels is not known: all eight cases.
    for (int shift = 0; shift < 8; ++shift) {
        Index onEdges = 0;
        for (Index i = 0; i < X.rows(); ++i) {
            int halves = 0;
            for (int c = 0; c < 3; ++c) halves += (axes[c].of[i] + (shift >> c)) & 1;
            onEdges += halves == 1;
        }
        if (static_cast<double>(onEdges) > kLeastShare * static_cast<double>(X.rows()))
            return 2.0 * Eigen::RowVector3d(axes[0].size, axes[1].size, axes[2].size);
    }
    return std::nullopt;
}

}  // namespace spectral
