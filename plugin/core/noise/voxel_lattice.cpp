#include "core/noise/voxel_lattice.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/support/threads.h"

namespace spectral {

namespace {

/// Coordinates along an axis as multiples of half a voxel.
struct HalfSteps {
    double size = 0.0;          ///< Half the size of a voxel; 0 if there is no lattice.
    Eigen::VectorXi multiples;  ///< n: each coordinate in half voxels.
};

HalfSteps halfSteps(const Eigen::VectorXd& coordinates) {
    constexpr double kEqual = 2e-5;  // differences below this part of the extent are round-off
    constexpr double kMinVerticesPerStep = 8;  // on average: many vertices share a lattice plane
    constexpr std::size_t kMinSteps = 4;
    constexpr double kTolerance = 0.02;      // distance from the lattice, half voxels
    constexpr double kMaxOffLattice = 0.01;  // share of the vertices
    std::vector<double> sorted(coordinates.begin(), coordinates.end());
    std::sort(sorted.begin(), sorted.end());
    const double extent = sorted.back() - sorted.front();
    std::vector<double> differences;
    for (std::size_t i = 1; i < sorted.size(); ++i)
        if (sorted[i] - sorted[i - 1] > kEqual * extent)
            differences.push_back(sorted[i] - sorted[i - 1]);
    if (differences.size() < kMinSteps ||
        kMinVerticesPerStep * static_cast<double>(differences.size()) >
            static_cast<double>(sorted.size()))
        return {};
    const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
    std::nth_element(differences.begin(), middle, differences.end());
    const Eigen::ArrayXd steps = (coordinates.array() - sorted.front()) / *middle;
    const Index offLattice = ((steps - steps.round()).abs() > kTolerance).count();
    if (static_cast<double>(offLattice) > kMaxOffLattice * static_cast<double>(sorted.size()))
        return {};
    return {*middle, steps.round().cast<int>()};
}

}  // namespace

std::optional<Eigen::RowVector3d> voxelLattice(const Points& X) {
    constexpr double kMinShare = 0.97;
    HalfSteps axes[3];
    parallelFor(3, [&](Index c) { axes[c] = halfSteps(X.col(c)); });
    for (const HalfSteps& axis : axes)
        if (axis.size == 0.0) return std::nullopt;
    // Try all eight choices of which multiples are whole voxels.
    for (int shift = 0; shift < 8; ++shift) {
        Index onEdges = 0;
        for (Index i = 0; i < X.rows(); ++i) {
            int halves = 0;
            for (int c = 0; c < 3; ++c) halves += (axes[c].multiples[i] + (shift >> c)) & 1;
            onEdges += halves == 1;
        }
        if (static_cast<double>(onEdges) > kMinShare * static_cast<double>(X.rows()))
            return 2.0 * Eigen::RowVector3d(axes[0].size, axes[1].size, axes[2].size);
    }
    return std::nullopt;
}

}  // namespace spectral
