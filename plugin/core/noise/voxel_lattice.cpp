#include "core/noise/voxel_lattice.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/graph/robust_statistics.h"
#include "core/support/threads.h"

namespace spectral {

namespace {

/// Coordinates along an axis as multiples of a step.
struct Multiples {
    double step = 0.0;          ///< 0 if there is no grid.
    Eigen::VectorXi multiples;  ///< n: each coordinate in steps.
    Index levels = 0;           ///< Number of different multiples.
};

Multiples multiplesOf(const Eigen::VectorXd& coordinates) {
    constexpr double kEqual = 2e-5;  // differences below this part of the extent are round-off
    constexpr std::size_t kMinSteps = 4;
    constexpr double kTolerance = 0.03;   // distance from the grid, steps
    constexpr double kMaxOffGrid = 0.01;  // share of the vertices
    std::vector<double> sorted(coordinates.begin(), coordinates.end());
    std::sort(sorted.begin(), sorted.end());
    const double extent = sorted.back() - sorted.front();
    std::vector<double> differences;
    for (std::size_t i = 1; i < sorted.size(); ++i)
        if (sorted[i] - sorted[i - 1] > kEqual * extent)
            differences.push_back(sorted[i] - sorted[i - 1]);
    if (differences.size() < kMinSteps) return {};
    const double median = quantile(differences, 0.5);
    // Differences are few steps, so that none is miscounted; their sum gives the step exactly.
    double steps = 0.0;
    for (const double difference : differences) steps += std::round(difference / median);
    const double step = extent / steps;
    const Eigen::ArrayXd multiples = (coordinates.array() - sorted.front()) / step;
    const Index offGrid = ((multiples - multiples.round()).abs() > kTolerance).count();
    if (static_cast<double>(offGrid) > kMaxOffGrid * static_cast<double>(sorted.size())) return {};
    return {step, multiples.round().cast<int>(), static_cast<Index>(differences.size()) + 1};
}

}  // namespace

std::optional<CoordinateGrid> coordinateGrid(const Points& X) {
    Multiples axes[3];
    parallelFor(3, [&](Index c) { axes[c] = multiplesOf(X.col(c)); });
    CoordinateGrid grid;
    grid.multiples.resize(X.rows(), 3);
    for (int c = 0; c < 3; ++c) {
        if (axes[c].step == 0.0) return std::nullopt;
        grid.step[c] = axes[c].step;
        grid.multiples.col(c) = axes[c].multiples;
        grid.levels = std::max(grid.levels, axes[c].levels);
    }
    return grid;
}

std::optional<Eigen::RowVector3d> voxelLattice(const CoordinateGrid& grid) {
    constexpr double kMinShareOnEdges = 0.97;
    constexpr Index kMinVerticesPerLevel = 8;  // on average: many vertices share a plane
    const Index n = grid.multiples.rows();
    if (kMinVerticesPerLevel * (grid.levels - 1) > n) return std::nullopt;
    // Try all eight choices of which multiples are whole voxels.
    for (int shift = 0; shift < 8; ++shift) {
        Index onEdges = 0;
        for (Index i = 0; i < n; ++i) {
            int halves = 0;
            for (int c = 0; c < 3; ++c) halves += (grid.multiples(i, c) + (shift >> c)) & 1;
            onEdges += halves == 1;
        }
        if (static_cast<double>(onEdges) > kMinShareOnEdges * static_cast<double>(n))
            return 2.0 * grid.step;
    }
    return std::nullopt;
}

}  // namespace spectral
