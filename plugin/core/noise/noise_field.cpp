#include "core/noise/noise_field.h"

#include <algorithm>
#include <cmath>

#include "core/graph/diffusion.h"
#include "core/graph/local_average.h"
#include "core/graph/robust_statistics.h"
#include "core/noise/noise_estimate.h"

namespace spectral {

namespace {

// Steps of the averages: over 460, 120, 90 and 30 vertices.
constexpr int kWide = 128, kMiddle = 32, kNear = 24, kNarrow = 8;

/// Where noise is certain, and where it extends to from there.
struct Limits {
    double correlation;  ///< Largest correlation of neighbouring residuals over kWide steps.
    double height;       ///< Least height over kWide steps, edges.
};
// Clean meshes and decimated ones have +.07 and more; a statue whose stone is as rough as weak
// noise once it is decimated to 4,000 to 15,000 vertices has -.17 up to .1 edges.
constexpr Limits kCertain{-0.1, 0.12}, kCertainWeak{-0.18, 0.06}, kPossible{0.15, 0.03};

using Flags = std::vector<bool>;
using Pair = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;

/// Correlation of the values of neighbours, in the place of each vertex.
Eigen::VectorXd localCorrelation(const VertexGraph& graph, const LocalAverage& average,
                                 const Eigen::VectorXd& values) {
    Pair products(values.size(), 2);
    forEachMean(graph, values, [&](Index i, const auto& mean) {
        products(i, 0) = values[i] * mean[0];
        products(i, 1) = values[i] * values[i];
    });
    products = average.of(std::move(products));
    return (products.col(1).array() > 0.0)
        .select(products.col(0).cwiseQuotient(products.col(1)), 1.0);
}

/// Mean length of the edges of the place.
Eigen::VectorXd localEdges(const VertexGraph& graph, const Points& X) {
    Eigen::VectorXd length(X.rows());
    parallelRows(X.rows(), [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) {
            double sum = 0.0;
            for (Index k = graph.first[i]; k < graph.first[i + 1]; ++k)
                sum += (X.row(i) - X.row(graph.at[k])).norm();
            length[i] = sum / static_cast<double>(std::max<Index>(graph.degree(i), 1));
        }
    });
    const Flags all(static_cast<std::size_t>(X.rows()), true);
    return LocalAverage(graph, all, kMiddle).of(std::move(length));
}

/// The largest value within so many rings of each vertex.
Eigen::VectorXd largestWithin(const VertexGraph& graph, int rings, Eigen::VectorXd values) {
    Eigen::VectorXd next = values;
    for (int ring = 0; ring < rings; ++ring) {
        parallelRows(values.size(), [&](Index begin, Index end) {
            for (Index i = begin; i < end; ++i) {
                double largest = values[i];
                for (Index k = graph.first[i]; k < graph.first[i + 1]; ++k)
                    largest = std::max(largest, values[graph.at[k]]);
                next[i] = largest;
            }
        });
        values.swap(next);
    }
    return values;
}

/// The possible vertices that are connected to a certain one.
Flags connectedTo(const Flags& isCertain, const Flags& isPossible, const VertexGraph& graph) {
    Flags isReached(isCertain.size(), false);
    std::vector<int> stack;
    const auto reach = [&](int i) {
        if (isReached[i] || !isPossible[i]) return;
        isReached[i] = true;
        stack.push_back(i);
    };
    for (int start = 0; start < graph.size(); ++start) {
        if (isCertain[start]) reach(start);
        while (!stack.empty()) {
            const int i = stack.back();
            stack.pop_back();
            for (Index k = graph.first[i]; k < graph.first[i + 1]; ++k) reach(graph.at[k]);
        }
    }
    return isReached;
}

/// Heights that would explain the octaves of the shape, in edges of the place.
struct Heights {
    Eigen::VectorXd fine;   ///< n: of the finest octave, over kNarrow steps.
    Eigen::VectorXd wide;   ///< n: over kWide steps, less what the shape can explain.
    Eigen::VectorXd shape;  ///< n: what it can explain.
};

Heights heightsOf(const FaceGraph& graph, const Points& X, const Points& N, const Flags& isMeasured,
                  const LocalAverage& wide, const Eigen::VectorXd& edge) {
    constexpr int kFineOctaves = 5;
    using Octaves = Eigen::Matrix<double, Eigen::Dynamic, kFineOctaves, Eigen::RowMajor>;
    Octaves octaves(X.rows(), kFineOctaves);
    forEachOctave(graph.vertices, X, N, isMeasured, kFineOctaves,
                  [&](int k, const Eigen::VectorXd& along, double white) {
                      octaves.col(k) = along.cwiseQuotient(white * edge);
                  });
    const auto explained = [&](const Octaves& deviation) {
        Eigen::VectorXd least = deviation.col(0);
        double factor = 1.0;
        for (int k = 1; k < kFineOctaves; ++k)
            least = least.cwiseMin(deviation.col(k) / (factor *= kRiseOfShape));
        return least;
    };
    Heights heights;
    const Octaves far = wide.deviation(octaves);
    heights.shape = explained(far);
    heights.wide = (far.col(0).array().square() - heights.shape.array().square()).max(0.0).sqrt();
    heights.fine = LocalAverage(graph.vertices, isMeasured, kNarrow)
                       .deviation(Eigen::VectorXd(octaves.col(0)));
    return heights;
}

/// Height at every vertex in edges of the place, 0 where there is no noise.
Eigen::VectorXd heightWhereNoise(const VertexGraph& graph, const Heights& heights,
                                 const Eigen::VectorXd& near, const Flags& isNoise) {
    constexpr int kRingsBeyond = 8, kRingsOfNoise = 3;
    constexpr double kMaxOverWide = 1.5;  // to the height over kWide steps
    constexpr double kMinRatio = 0.2, kMinRatioNear = 0.25;
    constexpr double kClean = 0.25,
                     kFadingCorrelation = 0.15;  // correlation of clean places; below it fades
    Eigen::VectorXd wide = heights.wide;
    for (Index i = 0; i < wide.size(); ++i)
        if (!isNoise[i]) wide[i] = 0.0;
    wide = largestWithin(graph, kRingsBeyond, std::move(wide));
    Eigen::VectorXd height = (heights.fine.array().square() - heights.shape.array().square())
                                 .max(0.0)
                                 .sqrt()
                                 .min(kMaxOverWide * wide.array());
    height.array() *= ((kClean - near.array()) / kFadingCorrelation).max(0.0).min(1.0);
    const Eigen::VectorXd around = largestWithin(graph, kRingsOfNoise, height);
    const Eigen::ArrayXd least =
        (kMinRatioNear * around.array()).max(kMinRatio * wide.array()).max(kMinHeight);
    return (height.array() < least).select(0.0, height);
}

/// The field with the statistics of its heights, which are those in edges of the place.
NoiseField inLengthUnits(NoiseField field, const Flags& isMeasured) {
    std::vector<double> relative;
    Index measured = 0, noisy = 0;
    for (Index i = 0; i < field.height.size(); ++i) {
        measured += isMeasured[i];
        if (!(field.height[i] > 0.0)) continue;
        noisy += isMeasured[i];
        relative.push_back(field.height[i]);
    }
    if (relative.empty()) return {};
    field.share = static_cast<double>(noisy) / static_cast<double>(measured);
    field.lowest = quantile(relative, 0.1);
    field.median = quantile(relative, 0.5);
    field.highest = quantile(std::move(relative), 0.98);
    field.height = field.height.cwiseProduct(field.edge);
    return field;
}

}  // namespace

LocalResiduals localResiduals(const FaceGraph& graph, const Points& X, const Flags& isMeasured) {
    LocalResiduals local;
    local.N = smoothVertexNormals(graph, X);
    local.residual = scaledResiduals(graph.vertices, X, local.N);
    for (Index i = 0; i < X.rows(); ++i)
        if (!isMeasured[i]) local.residual[i] = 0.0;
    local.deviation = LocalAverage(graph.vertices, isMeasured, kNarrow).deviation(local.residual);
    return local;
}

bool areAlike(const FaceGraph& graph, const Points& X, const LocalResiduals& residuals,
              const Flags& isMeasured) {
    // At most 1.9 with white noise, the same everywhere; 2.2 and more where its height differs by
    // place.
    constexpr double kMaxUnevenness = 2.1, kLow = 0.1, kHigh = 0.98;
    const auto isEven = [&](const Eigen::VectorXd& height) {
        std::vector<double> heights;
        for (Index i = 0; i < height.size(); ++i)
            if (isMeasured[i]) heights.push_back(height[i]);
        const double median = quantile(heights, 0.5);
        return quantile(heights, kHigh) < kMaxUnevenness * median &&
               median < kMaxUnevenness * quantile(heights, kLow);
    };
    return isEven(residuals.deviation) ||
           isEven(residuals.deviation.cwiseQuotient(localEdges(graph.vertices, X)));
}

double localTail(const VertexGraph& graph, const LocalResiduals& residuals,
                 const Flags& isIncluded) {
    constexpr double kTailShare = 0.99;
    // Along a crease the neighbours have like residuals, on the same side; those of a spike are on
    // the other side.
    constexpr double kLike = 0.5;
    const auto isOnCrease = [&](Index i) {
        const double r = residuals.residual[i];
        for (Index k = graph.first[i]; k < graph.first[i + 1]; ++k)
            if (residuals.residual[graph.at[k]] * r > kLike * r * r) return true;
        return false;
    };
    std::vector<double> units;
    for (Index i = 0; i < residuals.deviation.size(); ++i)
        if (isIncluded[i] && residuals.deviation[i] > 0.0)
            units.push_back(
                isOnCrease(i) ? 0.0 : std::abs(residuals.residual[i]) / residuals.deviation[i]);
    return quantile(std::move(units), kTailShare);
}

NoiseField NoiseField::ofHeight(double height, double edge, Index n) {
    NoiseField field;
    field.height.setConstant(n, height);
    field.edge.setConstant(n, edge);
    field.share = 1.0;
    field.lowest = field.median = field.highest = height / edge;
    return field;
}

NoiseField NoiseField::ofHeights(const FaceGraph& graph, const Points& X,
                                 const Eigen::VectorXd& heights) {
    NoiseField field;
    field.edge = localEdges(graph.vertices, X);
    field.height = heights.cwiseQuotient(field.edge);
    return inLengthUnits(std::move(field), Flags(graph.onRim.size(), true));
}

NoiseField measureNoiseField(const FaceGraph& graph, const Points& X, const Flags& isMeasured,
                             const LocalResiduals& local) {
    const VertexGraph& vertices = graph.vertices;
    const Index n = X.rows();
    const auto clipped = [&] {
        const Eigen::VectorXd limit = kResidualClip * local.deviation;
        return Eigen::VectorXd(local.residual.cwiseMax(-limit).cwiseMin(limit));
    }();
    const LocalAverage wide(vertices, isMeasured, kWide);
    const Eigen::VectorXd correlation = localCorrelation(vertices, wide, clipped);
    NoiseField field;
    if (!(correlation.array() < kCertain.correlation).any()) return field;

    field.edge = localEdges(vertices, X);
    const Heights heights = heightsOf(graph, X, local.N, isMeasured, wide, field.edge);
    Flags isCertain(static_cast<std::size_t>(n)), isPossible(isCertain);
    for (Index i = 0; i < n; ++i) {
        const auto isWithin = [&](const Limits& limits) {
            return isMeasured[i] && correlation[i] < limits.correlation &&
                   heights.wide[i] > limits.height;
        };
        isCertain[i] = isWithin(kCertain) || isWithin(kCertainWeak);
        isPossible[i] = isWithin(kPossible);
    }
    const Flags isNoise = connectedTo(isCertain, isPossible, vertices);

    // Each residual in units of its own place: loud neighbours do not decide.
    const Eigen::VectorXd unit = local.deviation.cwiseMax(1e-9 * field.edge.mean());
    const Eigen::VectorXd near = localCorrelation(
        vertices, LocalAverage(vertices, isMeasured, kNear), clipped.cwiseQuotient(unit));
    field.height = heightWhereNoise(vertices, heights, near, isNoise);

    return inLengthUnits(std::move(field), isMeasured);
}

}  // namespace spectral
