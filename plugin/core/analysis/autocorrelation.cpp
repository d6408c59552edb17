#include "core/analysis/autocorrelation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <optional>
#include <unsupported/Eigen/FFT>
#include <utility>

#include "core/support/types.h"

namespace spectral {

namespace {

using Grid = Eigen::MatrixXd;
using Spectrum = Eigen::MatrixXcd;

/// Equal steps along an axis, and the number of each point.
struct Steps {
    Index count = 0;
    std::vector<Index> number;
};

/// The steps of some values, if these are multiples of one to single precision.
std::optional<Steps> stepsOf(const Eigen::VectorXd& values) {
    constexpr double kOff = 1e-3;  // of a step
    std::vector<double> sorted(values.begin(), values.end());
    std::sort(sorted.begin(), sorted.end());
    const double range = sorted.back() - sorted.front();
    std::vector<double> gaps;
    for (std::size_t i = 1; i < sorted.size(); ++i)
        if (sorted[i] > sorted[i - 1]) gaps.push_back(sorted[i] - sorted[i - 1]);
    if (gaps.empty()) return {};
    std::nth_element(gaps.begin(), gaps.begin() + gaps.size() / 2, gaps.end());
    const double median = gaps[gaps.size() / 2];
    double sum = 0.0, count = 0.0;  // of single steps, each rounded
    for (const double gap : gaps)
        if (gap < 1.5 * median) {
            sum += gap;
            count += 1.0;
        }
    double step = sum / count;
    const double steps = std::round(range / step);
    if (!(steps < static_cast<double>(values.size()))) return {};
    step = range / steps;
    const double rounded = std::numeric_limits<float>::epsilon() *
                           std::max(std::abs(sorted.front()), std::abs(sorted.back())) / step;
    Steps found;
    found.count = static_cast<Index>(steps) + 1;
    for (const double value : values) {
        const double at = (value - sorted.front()) / step;
        if (std::abs(at - std::round(at)) > std::max(kOff, rounded)) return {};
        found.number.push_back(static_cast<Index>(std::round(at)));
    }
    return found;
}

/// Rows in the cells of a grid, -1 where there is none; empty if two are in a cell, or too few.
Eigen::MatrixXi cellsOf(const Steps& one, const Steps& other, const std::vector<Index>& rows) {
    if (one.count * other.count >= 2 * static_cast<Index>(rows.size())) return {};
    Eigen::MatrixXi grid = Eigen::MatrixXi::Constant(one.count, other.count, -1);
    for (std::size_t k = 0; k < rows.size(); ++k) {
        int& cell = grid(one.number[k], other.number[k]);
        if (std::exchange(cell, static_cast<int>(rows[k])) >= 0) return {};
    }
    return grid;
}

/// The grid on which these rows lie, by two of their coordinates; heights may have steps, too.
Eigen::MatrixXi gridOf(const Vertices& points, const std::vector<Index>& rows) {
    std::array<std::optional<Steps>, 3> axes;
    for (int axis = 0; axis < 3; ++axis) {
        Eigen::VectorXd values(static_cast<Index>(rows.size()));
        for (Index k = 0; k < values.size(); ++k) values[k] = points(rows[k], axis);
        axes[axis] = stepsOf(values);
    }
    for (const auto& [one, other] : {std::pair{0, 1}, {0, 2}, {1, 2}})
        if (axes[one] && axes[other])
            if (Eigen::MatrixXi grid = cellsOf(*axes[one], *axes[other], rows); grid.size() > 0)
                return grid;
    return {};
}

/// The next product of 2, 3 and 5, whose transforms are fast.
Index fastSize(Index least) {
    for (Index size = least;; ++size) {
        Index rest = size;
        for (const Index factor : {2, 3, 5})
            while (rest % factor == 0) rest /= factor;
        if (rest == 1) return size;
    }
}

/// Transforms columns, then rows.
Spectrum transformed(const Spectrum& values, bool isInverse) {
    Eigen::FFT<double> fft;
    const auto columns = [&](const Spectrum& before) {
        Spectrum after(before.rows(), before.cols());
        Eigen::VectorXcd column(before.rows());
        for (Index j = 0; j < before.cols(); ++j) {
            if (isInverse)
                fft.inv(column, Eigen::VectorXcd(before.col(j)));
            else
                fft.fwd(column, Eigen::VectorXcd(before.col(j)));
            after.col(j) = column;
        }
        return after;
    };
    return columns(columns(values).transpose()).transpose();
}

/// Mean products of heights at each lag, relative to that at none: rows are lags -a to a of the
/// first axis, columns -b to b of the second.
Grid autocorrelation(const Grid& heights, const Grid& isThere) {
    const Index a = heights.rows() / 2, b = heights.cols() / 2;
    const Index rows = fastSize(heights.rows() + a + 1);
    const Index cols = fastSize(heights.cols() + b + 1);
    // Both are real: one is transformed as the imaginary part of the other, there and back.
    const std::complex<double> i1(0.0, 1.0);
    Spectrum both = Spectrum::Zero(rows, cols);
    both.topLeftCorner(heights.rows(), heights.cols()) = heights + i1 * isThere;
    both = transformed(both, false);
    Spectrum values(rows, cols);
    for (Index j = 0; j < cols; ++j)
        for (Index i = 0; i < rows; ++i) {
            const auto one = both(i, j),
                       mirrored = std::conj(both((rows - i) % rows, (cols - j) % cols));
            values(i, j) = 0.25 * (std::norm(one + mirrored) + i1 * std::norm(one - mirrored));
        }
    values = transformed(values, true);
    Grid means(2 * a + 1, 2 * b + 1);
    for (Index i = -a; i <= a; ++i)
        for (Index j = -b; j <= b; ++j) {
            const auto sums = values((i + rows) % rows, (j + cols) % cols);
            means(i + a, j + b) = sums.imag() > 0.5 ? sums.real() / sums.imag() : 0.0;
        }
    return means / means(a, b);
}

/// The mean of the step from a cell to the next of a grid.
Eigen::RowVector3d meanStep(const Eigen::MatrixXi& grid, const Vertices& X, Index down,
                            Index right) {
    Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
    double count = 0.0;
    for (Index j = 0; j + right < grid.cols(); ++j)
        for (Index i = 0; i + down < grid.rows(); ++i) {
            const int one = grid(i, j), next = grid(i + down, j + right);
            if (one < 0 || next < 0) continue;
            sum += X.row(next) - X.row(one);
            count += 1.0;
        }
    return sum / std::max(count, 1.0);
}

/// Whether each lag belongs to the central peak, that is, is above a level.
std::vector<bool> centralPeak(const Grid& means, double level) {
    const Index rows = means.rows(), middle = means.size() / 2;
    std::vector<bool> isIn(static_cast<std::size_t>(means.size()), false);
    std::vector<Index> next{middle};
    isIn[middle] = true;
    const auto visit = [&](Index at) {
        if (isIn[at] || means(at) <= level) return;
        isIn[at] = true;
        next.push_back(at);
    };
    while (!next.empty()) {
        const Index at = next.back(), i = at % rows;
        next.pop_back();
        if (i > 0) visit(at - 1);
        if (i + 1 < rows) visit(at + 1);
        if (at >= rows) visit(at - rows);
        if (at + rows < means.size()) visit(at + rows);
    }
    return isIn;
}

}  // namespace

TextureLengths textureLengths(const Eigen::VectorXd& h, const Vertices& points,
                              const Vertices& reference, const std::vector<bool>& counts) {
    constexpr double kLevel = 0.2;  // the default of ISO 25178-3
    std::vector<Index> rows;
    double mean = 0.0;
    for (Index i = 0; i < h.size(); ++i)
        if (counts[i]) {
            rows.push_back(i);
            mean += h[i];
        }
    if (rows.empty()) return {};
    mean /= static_cast<double>(rows.size());
    const Eigen::MatrixXi grid = gridOf(points, rows);
    if (grid.size() == 0) return {};
    Grid heights = Grid::Zero(grid.rows(), grid.cols()), isThere = heights;
    for (Index k = 0; k < grid.size(); ++k)
        if (grid(k) >= 0) {
            heights(k) = h[grid(k)] - mean;
            isThere(k) = 1.0;
        }
    if (heights.squaredNorm() == 0.0) return {};
    const Grid means = autocorrelation(heights, isThere);
    const Eigen::RowVector3d down = meanStep(grid, reference, 1, 0);
    const Eigen::RowVector3d right = meanStep(grid, reference, 0, 1);
    const std::vector<bool> isIn = centralPeak(means, kLevel);
    const Index a = means.rows() / 2, b = means.cols() / 2;
    const auto in = [&](Index i, Index j) { return isIn[i + j * means.rows()]; };
    double least = std::numeric_limits<double>::infinity(), most = 0.0;
    bool isWhole = true;  // the peak ends within the lags
    for (Index j = 0; j < means.cols(); ++j)
        for (Index i = 0; i < means.rows(); ++i) {
            if (!in(i, j)) continue;
            if (i == 0 || j == 0 || i + 1 == means.rows() || j + 1 == means.cols()) {
                isWhole = false;
                continue;
            }
            for (Index q = j - 1; q <= j + 1; ++q)
                for (Index p = i - 1; p <= i + 1; ++p) {
                    if (in(p, q) || means(p, q) > kLevel) continue;
                    const double t = (means(i, j) - kLevel) / (means(i, j) - means(p, q));
                    const double y = static_cast<double>(i - a) + t * static_cast<double>(p - i);
                    const double x = static_cast<double>(j - b) + t * static_cast<double>(q - j);
                    const double lag = (y * down + x * right).norm();
                    least = std::min(least, lag);
                    most = std::max(most, lag);
                }
        }
    if (most == 0.0) return {};
    return {least, isWhole ? least / most : 0.0};
}

}  // namespace spectral
