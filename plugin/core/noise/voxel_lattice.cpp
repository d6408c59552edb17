#include "core/noise/voxel_lattice.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/graph/diffusion.h"
#include "core/graph/robust_statistics.h"
#include "core/support/threads.h"

namespace spectral {

namespace {

/// Coordinates along an axis as multiples of a step.
struct Multiples {
    double step = 0.0;          ///< 0 if there is no grid.
    Eigen::VectorXi multiples;  ///< n: each coordinate in steps.
};

/// @param minShared   vertices that share a level; others, such as moved ones, do not count for the
///                    step.
/// @param maxOffGrid  share of the vertices.
Multiples multiplesOf(const Eigen::VectorXd& coordinates, std::size_t minShared,
                      double maxOffGrid) {
    constexpr double kEqual = 2e-5;  // differences below this part of the extent are round-off
    constexpr std::size_t kMinSteps = 4;
    constexpr double kTolerance = 0.03;  // distance from the grid, steps
    std::vector<double> sorted(coordinates.begin(), coordinates.end());
    std::sort(sorted.begin(), sorted.end());
    const double extent = sorted.back() - sorted.front();
    std::vector<double> levels;
    for (std::size_t i = 0, next = 0; i < sorted.size(); i = next) {
        while (++next < sorted.size() && sorted[next] - sorted[next - 1] <= kEqual * extent) {
        }
        if (next - i >= minShared) levels.push_back(0.5 * (sorted[i] + sorted[next - 1]));
    }
    if (levels.size() <= kMinSteps) return {};
    std::vector<double> differences;
    for (std::size_t i = 1; i < levels.size(); ++i)
        differences.push_back(levels[i] - levels[i - 1]);
    const double median = quantile(differences, 0.5);
    // Differences are few steps, so that none is miscounted; their sum gives the step exactly.
    double steps = 0.0;
    for (const double difference : differences) steps += std::round(difference / median);
    const double step = (levels.back() - levels.front()) / steps;
    const Eigen::ArrayXd multiples = (coordinates.array() - levels.front()) / step;
    const Index offGrid = ((multiples - multiples.round()).abs() > kTolerance).count();
    if (static_cast<double>(offGrid) > maxOffGrid * static_cast<double>(sorted.size())) return {};
    return {step, multiples.round().cast<int>()};
}

/// Where all vertices are on the grid, or else where the commonest levels make one.
Multiples multiplesOf(const Eigen::VectorXd& coordinates, bool areAllOn) {
    // A segmentation's surface has 40 vertices on a level and more; decimated to nine tenths, a
    // tenth is off it.
    constexpr std::size_t kMinShared = 4;
    constexpr double kMaxOffGrid = 0.01, kMaxOffLattice = 0.2;
    return areAllOn ? multiplesOf(coordinates, 1, kMaxOffGrid)
                    : multiplesOf(coordinates, kMinShared, kMaxOffLattice);
}

}  // namespace

std::optional<CoordinateGrid> coordinateGrid(const Points& X, bool areAllOn) {
    Multiples axes[3];
    parallelFor(3, [&](Index c) { axes[c] = multiplesOf(X.col(c), areAllOn); });
    CoordinateGrid grid;
    grid.multiples.resize(X.rows(), 3);
    for (int c = 0; c < 3; ++c) {
        if (axes[c].step == 0.0) return std::nullopt;
        grid.step[c] = axes[c].step;
        grid.multiples.col(c) = axes[c].multiples;
    }
    return grid;
}

std::vector<Eigen::Matrix3d> latticeAxes(const FaceGraph& graph, const Points& X) {
    constexpr Index kSamples = 2000;
    constexpr double kSame = 1.0 - 1e-6;  // cosine
    constexpr double kOrthogonal = 1e-3;
    constexpr std::size_t kMaxDirections = 24;
    constexpr double kMinCovered = 0.75;  // of the faces, by the commonest directions
    const Points N = areaNormals(X, graph.F);
    // The same faces in the same order, whatever the numbering.
    const std::vector<std::uint64_t> bits = randomBits(X);
    std::vector<std::pair<std::uint64_t, Index>> sampled;
    for (Index f = 0; f < N.rows(); ++f)
        sampled.emplace_back(bits[graph.F(f, 0)] + bits[graph.F(f, 1)] + bits[graph.F(f, 2)], f);
    const auto last = sampled.begin() + std::min(kSamples, N.rows());
    std::partial_sort(sampled.begin(), last, sampled.end());
    sampled.erase(last, sampled.end());
    std::vector<Eigen::Vector3d> sums;
    std::vector<Index> counts;
    Index samples = 0;
    for (const auto& [key, f] : sampled) {
        const Eigen::Vector3d normal = N.row(f).transpose();
        if (!(normal.norm() > 0.0)) continue;
        ++samples;
        std::size_t k = 0;
        while (k < sums.size() &&
               !(std::abs(sums[k].dot(normal)) > kSame * sums[k].norm() * normal.norm()))
            ++k;
        if (k == sums.size()) {
            // Other surfaces have as many directions as faces.
            if (static_cast<double>(k) > 8 * kMaxDirections + 0.25 * static_cast<double>(samples))
                return {};
            sums.push_back(normal);
            counts.push_back(1);
        } else {
            sums[k] += sums[k].dot(normal) > 0.0 ? normal : Eigen::Vector3d(-normal);
            ++counts[k];
        }
    }
    std::vector<std::size_t> order(sums.size());
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return counts[a] != counts[b] ? counts[a] > counts[b] : a < b;
    });
    order.resize(std::min(order.size(), kMaxDirections));
    Index covered = 0;
    for (const std::size_t k : order) covered += counts[k];
    if (static_cast<double>(covered) < kMinCovered * static_cast<double>(samples)) return {};
    std::vector<Eigen::Matrix3d> found;
    const auto at = [&](std::size_t k) { return Eigen::Vector3d(sums[order[k]].normalized()); };
    const auto areOrthogonal = [&](std::size_t a, std::size_t b) {
        return std::abs(at(a).dot(at(b))) < kOrthogonal;
    };
    for (std::size_t a = 0; a < order.size(); ++a)
        for (std::size_t b = a + 1; b < order.size(); ++b)
            for (std::size_t c = b + 1; areOrthogonal(a, b) && c < order.size(); ++c) {
                if (!areOrthogonal(a, c) || !areOrthogonal(b, c)) continue;
                Eigen::Matrix3d axes;
                axes << at(a), at(b), at(c);
                // The nearest rotation.
                const Eigen::JacobiSVD<Eigen::Matrix3d> svd(
                    axes, Eigen::ComputeFullU | Eigen::ComputeFullV);
                found.push_back((svd.matrixU() * svd.matrixV().transpose()).transpose());
            }
    return found;
}

std::optional<Eigen::RowVector3d> voxelLattice(const CoordinateGrid& grid, bool areAllOn) {
    const double minShareOnEdges = areAllOn ? 0.97 : 0.75;  // 3/8 at random
    const Index n = grid.multiples.rows();
    // Try all eight choices of which multiples are whole voxels.
    for (int shift = 0; shift < 8; ++shift) {
        Index onEdges = 0;
        for (Index i = 0; i < n; ++i) {
            int halves = 0;
            for (int c = 0; c < 3; ++c) halves += (grid.multiples(i, c) + (shift >> c)) & 1;
            onEdges += halves == 1;
        }
        if (static_cast<double>(onEdges) > minShareOnEdges * static_cast<double>(n))
            return 2.0 * grid.step;
    }
    return std::nullopt;
}

}  // namespace spectral
