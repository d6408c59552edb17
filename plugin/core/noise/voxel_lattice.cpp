#include "core/noise/voxel_lattice.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "core/graph/diffusion.h"
#include "core/graph/robust_statistics.h"
#include "core/support/threads.h"

namespace spectral {

namespace {

constexpr double kTolerance = 0.03;  // distance from the grid, steps
constexpr double kMaxOffGrid = 0.01;

/// The different values of the coordinates along an axis, ascending: those that so many share.
/// Others, such as moved vertices, say nothing about the step.
std::vector<double> levelsOf(const std::vector<double>& sorted, std::size_t minShared) {
    constexpr double kEqual = 2e-5;  // differences below this part of the extent are round-off
    const double extent = sorted.back() - sorted.front();
    std::vector<double> levels;
    for (std::size_t i = 0, next = 0; i < sorted.size(); i = next) {
        while (++next < sorted.size() && sorted[next] - sorted[next - 1] <= kEqual * extent) {
        }
        if (next - i >= minShared) levels.push_back(0.5 * (sorted[i] + sorted[next - 1]));
    }
    return levels;
}

constexpr std::size_t kMinSteps = 4;

/// The step of levels that are multiples of it; 0 if there are too few.
/// @param ofDifferences  quantile of their differences that is a step.
double stepOf(const std::vector<double>& levels, double ofDifferences) {
    if (levels.size() <= kMinSteps) return 0.0;
    std::vector<double> differences;
    for (std::size_t i = 1; i < levels.size(); ++i)
        differences.push_back(levels[i] - levels[i - 1]);
    const double usual = quantile(differences, ofDifferences);
    // Differences are few steps, so that none is miscounted; their sum gives the step exactly.
    double steps = 0.0;
    for (const double difference : differences) steps += std::round(difference / usual);
    return (levels.back() - levels.front()) / steps;
}

/// The period of levels of which one to three are in each: their commonest difference; 0 if there
/// are too few.
double periodOf(const std::vector<double>& levels) {
    constexpr double kSame = 1e-3;
    std::vector<double> differences;
    for (std::size_t i = 0; i < levels.size(); ++i)
        for (std::size_t j = i + 1; j <= i + 3 && j < levels.size(); ++j)
            differences.push_back(levels[j] - levels[i]);
    if (levels.size() <= kMinSteps) return 0.0;
    std::sort(differences.begin(), differences.end());
    std::size_t most = 0;
    double period = 0.0;
    for (std::size_t i = 0, end = 0; i < differences.size(); ++i) {
        while (end < differences.size() && differences[end] <= (1.0 + kSame) * differences[i])
            ++end;
        if (end - i <= most) continue;
        most = end - i;
        period = std::accumulate(differences.begin() + static_cast<std::ptrdiff_t>(i),
                                 differences.begin() + static_cast<std::ptrdiff_t>(end), 0.0) /
                 static_cast<double>(most);
    }
    return period;
}

Index countOff(const Eigen::ArrayXd& multiples) {
    return ((multiples - multiples.round()).abs() > kTolerance).count();
}

using Halves = Eigen::VectorXi;

/// n: coordinates along an axis in halves of a cell, where midpoints are odd; none if they are on
/// no grid.
/// @param ofDifferences  quantile of the levels' differences that is half of a cell.
/// @param maxOff         share of the vertices off the grid.
std::optional<Halves> halvesOfMidpoints(const Eigen::VectorXd& coordinates,
                                        const std::vector<double>& levels, double ofDifferences,
                                        double maxOff, double& cell) {
    const double half = stepOf(levels, ofDifferences);
    if (!(half > 0.0)) return std::nullopt;
    cell = 2.0 * half;
    const Eigen::ArrayXd multiples = (coordinates.array() - levels.front()) / half;
    if (static_cast<double>(countOff(multiples)) > maxOff * static_cast<double>(coordinates.size()))
        return std::nullopt;
    return multiples.round().cast<int>();
}

/// The same where those between are not midpoints: on one side of it or on both.
std::optional<Halves> halvesOfAnyLevel(const Eigen::VectorXd& coordinates,
                                       const std::vector<double>& levels, double& cell) {
    cell = periodOf(levels);
    if (!(cell > 0.0)) return std::nullopt;
    Eigen::ArrayXd best;
    Index leastOff = coordinates.size();
    for (std::size_t k = 0; k < 3; ++k) {  // which levels are whole
        Eigen::ArrayXd multiples = (coordinates.array() - levels[k]) / cell;
        const Index off = countOff(multiples);
        if (off >= leastOff) continue;
        leastOff = off;
        best = std::move(multiples);
    }
    if (best.size() == 0) return std::nullopt;
    const Eigen::ArrayXd isBetween = ((best - best.round()).abs() > kTolerance).cast<double>();
    return (2.0 * best.round() + isBetween * (2.0 * (best.floor() - best.round()) + 1.0))
        .cast<int>();
}

/// The largest number of cells that all values, in halves of a cell, are apart, but for a few.
int cellsApart(const std::vector<int>& halves) {
    constexpr int kMaxCells = 16;
    constexpr double kMinShare = 0.97;
    constexpr std::ptrdiff_t kMinValues = 4;
    for (int cells = kMaxCells; cells > 1; --cells) {
        const int stride = 2 * cells;
        std::vector<std::size_t> counts(static_cast<std::size_t>(stride));
        for (const int value : halves)
            ++counts[static_cast<std::size_t>(((value % stride) + stride) % stride)];
        const auto most = std::max_element(counts.begin(), counts.end());
        if (static_cast<double>(*most) < kMinShare * static_cast<double>(halves.size())) continue;
        const auto [least, greatest] = std::minmax_element(halves.begin(), halves.end());
        if (*greatest - *least >= kMinValues * stride) return cells;
    }
    return 1;
}

}  // namespace

SortedPoints::SortedPoints(Points points) : X(std::move(points)) {
    parallelFor(3, [&](Index c) {
        sorted[c].assign(X.col(c).begin(), X.col(c).end());
        std::sort(sorted[c].begin(), sorted[c].end());
    });
}

std::optional<CoordinateGrid> coordinateGrid(const SortedPoints& points) {
    const Points& X = points.X;
    CoordinateGrid grid;
    grid.step.setZero();
    parallelFor(3, [&](Index c) {
        const std::vector<double> levels = levelsOf(points.sorted[c], 1);
        const double step = stepOf(levels, 0.5);
        if (step > 0.0 &&
            static_cast<double>(countOff((X.col(c).array() - levels.front()) / step)) <=
                kMaxOffGrid * static_cast<double>(X.rows()))
            grid.step[c] = step;
    });
    if (!(grid.step.minCoeff() > 0.0)) return std::nullopt;
    return grid;
}

std::vector<Eigen::Matrix3d> latticeAxes(const FaceGraph& graph, const Points& X) {
    constexpr Index kSamples = 2000;
    constexpr double kSame = 1.0 - 1e-6;  // cosine
    constexpr double kOrthogonal = 1e-3;
    constexpr std::size_t kMaxDirections = 24;
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

std::optional<VoxelLattice> voxelLattice(const SortedPoints& points, bool areAllOn) {
    // A segmentation's surface has 40 vertices on a level and more; decimated to nine tenths, a
    // tenth is off it.
    constexpr std::size_t kMinShared = 4;
    constexpr double kMaxOffLattice = 0.2;
    // On each axis; where the step is half of the true one, all coordinates are odd or none are.
    constexpr double kMinBetween = 0.005;
    const double minShareOnEdges = areAllOn ? 0.97 : 0.75;  // 3/8 at random
    const Points& X = points.X;
    const auto n = static_cast<double>(X.rows());
    std::array<std::vector<double>, 3> levels;
    for (int c = 0; c < 3; ++c) {
        levels[c] = levelsOf(points.sorted[c], areAllOn ? 1 : kMinShared);
        if (static_cast<double>(kMinShared * levels[c].size()) > n) return std::nullopt;
    }
    // Midpoints are at every second level, or seldom, where voxels were divided.
    enum class Reading { AnyLevel, Midpoints, SeldomMidpoints };
    constexpr double kUsual = 0.5, kSeldom = 0.02;
    for (const Reading reading :
         {Reading::AnyLevel, Reading::Midpoints, Reading::SeldomMidpoints}) {
        // Vertices off the lattice make periods of their own.
        if (reading == Reading::AnyLevel && !areAllOn) continue;
        Eigen::Matrix<int, Eigen::Dynamic, 3> halves(X.rows(), 3);
        VoxelLattice lattice;
        bool isGrid = true;
        for (int c = 0; isGrid && c < 3; ++c) {
            const auto column =
                reading == Reading::AnyLevel
                    ? halvesOfAnyLevel(X.col(c), levels[c], lattice.voxel[c])
                    : halvesOfMidpoints(X.col(c), levels[c],
                                        reading == Reading::Midpoints ? kUsual : kSeldom,
                                        areAllOn ? kMaxOffGrid : kMaxOffLattice, lattice.voxel[c]);
            isGrid = column.has_value();
            if (isGrid) halves.col(c) = *column;
        }
        // Of midpoints, try all eight choices of which halves are whole.
        const int shifts = !isGrid ? 0 : reading == Reading::AnyLevel ? 1 : 8;
        for (int shift = 0; shift < shifts; ++shift) {
            std::array<std::vector<int>, 3> between;
            for (Index i = 0; i < X.rows(); ++i) {
                int odd = 0, at = 0;
                for (int c = 0; c < 3; ++c)
                    if ((halves(i, c) + (shift >> c)) & 1) {
                        ++odd;
                        at = c;
                    }
                if (odd == 1) between[at].push_back(halves(i, at));
            }
            double onEdges = 0.0, cells = 1.0;
            bool isOnAll = true;
            for (const auto& ofAxis : between) {
                const auto count = static_cast<double>(ofAxis.size());
                onEdges += count;
                isOnAll = isOnAll && count > kMinBetween * n;
            }
            if (!isOnAll || !(onEdges > minShareOnEdges * n)) continue;
            for (int c = 0; c < 3; ++c) {
                const int apart = cellsApart(between[c]);
                lattice.voxel[c] *= apart;
                cells *= apart;
            }
            lattice.edges = std::cbrt(cells);
            return lattice;
        }
    }
    return std::nullopt;
}

}  // namespace spectral
