#include "core/analysis/height_statistics.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/laplacian/laplacian.h"

namespace spectral {

namespace {

/// Moments of the distribution of the heights, and its ends.
void measureHeights(const Eigen::VectorXd& h, const Eigen::VectorXd& areas,
                    const std::vector<bool>& counts, TextureParameters& texture) {
    double sum = 0.0, squares = 0.0, cubes = 0.0, fourths = 0.0;
    double highest = 0.0, lowest = 0.0;
    for (Index i = 0; i < h.size(); ++i) {
        if (!counts[i]) continue;
        texture.area += areas[i];
        sum += areas[i] * std::abs(h[i]);
        squares += areas[i] * std::pow(h[i], 2);
        cubes += areas[i] * std::pow(h[i], 3);
        fourths += areas[i] * std::pow(h[i], 4);
        highest = std::max(highest, h[i]);
        lowest = std::min(lowest, h[i]);
    }
    texture.Sa = sum / texture.area;
    texture.Sq = std::sqrt(squares / texture.area);
    texture.Sp = highest;
    texture.Sv = -lowest;
    texture.Sz = highest - lowest;
    if (texture.Sq == 0.0) return;
    texture.Ssk = cubes / texture.area / std::pow(texture.Sq, 3);
    texture.Sku = fourths / texture.area / std::pow(texture.Sq, 4);
}

/// Area of the triangles whose corners all count and are below a thousandth of Sq: samples of waves
/// may be exactly at their zeros.
double flatArea(const Eigen::VectorXd& h, const Vertices& reference, const Faces& F,
                const std::vector<bool>& counts, double Sq) {
    constexpr double kFlat = 1e-3;
    const auto isFlat = [&](int i) { return counts[i] && std::abs(h[i]) < kFlat * Sq; };
    double area = 0.0;
    for (Index t = 0; t < F.rows(); ++t) {
        if (!isFlat(F(t, 0)) || !isFlat(F(t, 1)) || !isFlat(F(t, 2))) continue;
        const Eigen::RowVector3d a = reference.row(F(t, 1)) - reference.row(F(t, 0));
        const Eigen::RowVector3d b = reference.row(F(t, 2)) - reference.row(F(t, 0));
        area += 0.5 * a.cross(b).norm();
    }
    return area;
}

/// Evaluated vertices from the highest to the lowest.
std::vector<Index> descending(const Eigen::VectorXd& h, const std::vector<bool>& counts) {
    std::vector<Index> order;
    for (Index i = 0; i < h.size(); ++i)
        if (counts[i]) order.push_back(i);
    std::sort(order.begin(), order.end(),
              [&](Index i, Index j) { return h[i] > h[j] || (h[i] == h[j] && i < j); });
    return order;
}

/// The heights that 0, 1 / parts, ..., 1 of the area exceed.
Eigen::VectorXd bearingCurve(const Eigen::VectorXd& h, const Eigen::VectorXd& areas,
                             const std::vector<Index>& order, double area, int parts) {
    Eigen::VectorXd heights = Eigen::VectorXd::Constant(parts + 1, h[order.back()]);
    double above = 0.0;
    int part = 0;
    for (const Index i : order) {
        for (; part < parts && part * area <= above * parts; ++part) heights[part] = h[i];
        above += areas[i];
    }
    return heights;
}

void measureDistribution(const Eigen::VectorXd& h, const Eigen::VectorXd& areas,
                         const std::vector<Index>& order, TextureParameters& texture) {
    constexpr int kPercent = 100;
    const double top = h[order.front()], bottom = h[order.back()];
    const double width = (top - bottom) / kHistogramBins;
    texture.histogramHeights =
        Eigen::VectorXd::LinSpaced(kHistogramBins, bottom + 0.5 * width, top - 0.5 * width);
    texture.histogramShares = Eigen::VectorXd::Zero(kHistogramBins);
    texture.bearingHeights = bearingCurve(h, areas, order, texture.area, kPercent);
    for (const Index i : order) {
        const int bin = width > 0.0 ? static_cast<int>((h[i] - bottom) / width) : 0;
        texture.histogramShares[std::min(bin, kHistogramBins - 1)] += areas[i] / texture.area;
    }
}

void measureCore(const Eigen::VectorXd& h, const Eigen::VectorXd& areas,
                 const std::vector<Index>& order, TextureParameters& texture) {
    constexpr int kParts = 1000, kCore = 400;  // of the area, in the curve and in its core
    const Eigen::VectorXd curve = bearingCurve(h, areas, order, texture.area, kParts);
    int first = 0;
    for (int k = 1; k + kCore <= kParts; ++k)
        if (curve[k] - curve[k + kCore] < curve[first] - curve[first + kCore]) first = k;
    const Eigen::VectorXd ratio =
        Eigen::VectorXd::LinSpaced(kCore + 1, first, first + kCore) / kParts;
    const Eigen::VectorXd core = curve.segment(first, kCore + 1);
    const Eigen::ArrayXd centred = ratio.array() - ratio.mean();
    const double slope = (centred * core.array()).sum() / centred.square().sum();
    const double top = core.mean() - slope * ratio.mean(), bottom = top + slope;
    double peaks = 0.0, valleys = 0.0, above = 0.0, below = 0.0;
    constexpr double kRoundOff = 1e-9;  // the bars of a grating are of one height
    const double least = kRoundOff * texture.Sz;
    for (const Index i : order) {
        if (h[i] > top + least) {
            above += areas[i];
            peaks += areas[i] * (h[i] - top);
        } else if (h[i] < bottom - least) {
            below += areas[i];
            valleys += areas[i] * (bottom - h[i]);
        }
    }
    texture.Sk = top - bottom;
    texture.Smr1 = above / texture.area;
    texture.Smr2 = 1.0 - below / texture.area;
    // The heights of triangles of the same areas over the same shares.
    if (above > 0.0) texture.Spk = 2.0 * peaks / above;
    if (below > 0.0) texture.Svk = 2.0 * valleys / below;
}

/// Squared slope of a height that is linear on a triangle of the reference; -1 without area.
double squaredSlope(const Eigen::RowVector3d& a, const Eigen::RowVector3d& b, double da,
                    double db) {
    const double aa = a.squaredNorm(), ab = a.dot(b), bb = b.squaredNorm();
    const double determinant = aa * bb - ab * ab;
    if (!(determinant > 0.0)) return -1.0;
    return (bb * da * da - 2.0 * ab * da * db + aa * db * db) / determinant;
}

}  // namespace

TextureSlopes slopesOf(const Eigen::VectorXd& h, const Vertices& reference, const Faces& F,
                       const std::vector<bool>& counts) {
    double total = 0.0, slopes = 0.0, added = 0.0;
    for (Index t = 0; t < F.rows(); ++t) {
        const int i = F(t, 0), j = F(t, 1), k = F(t, 2);
        if (!counts[i] || !counts[j] || !counts[k]) continue;
        const Eigen::RowVector3d a = reference.row(j) - reference.row(i);
        const Eigen::RowVector3d b = reference.row(k) - reference.row(i);
        const double squared = squaredSlope(a, b, h[j] - h[i], h[k] - h[i]);
        if (squared < 0.0) continue;
        const double area = 0.5 * a.cross(b).norm();
        total += area;
        slopes += area * squared;
        added += area * squared / (std::sqrt(1.0 + squared) + 1.0);  // sqrt(1 + s) - 1
    }
    if (total == 0.0) return {};
    return {std::sqrt(slopes / total), added / total};
}

TextureParameters textureParameters(const Eigen::VectorXd& h, const Vertices& reference,
                                    const Faces& F, const std::vector<bool>& counts) {
    TextureParameters texture;
    const Eigen::VectorXd areas = lumpedMass(reference, F);
    measureHeights(h, areas, counts, texture);
    texture.flat = flatArea(h, reference, F, counts, texture.Sq) / texture.area;
    const std::vector<Index> order = descending(h, counts);
    measureDistribution(h, areas, order, texture);
    measureCore(h, areas, order, texture);
    static_cast<TextureSlopes&>(texture) = slopesOf(h, reference, F, counts);
    return texture;
}

}  // namespace spectral
