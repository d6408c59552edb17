#include "core/filter/thin_parts.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "core/laplacian/laplacian.h"
#include "core/support/threads.h"

namespace spectral {

namespace {

/// Fraction of its area that a part keeps; smoothing noise of 0.3 edges takes less.
constexpr double kKeptArea = 0.75;

/// Area of a noisy surface relative to that after F^(1/4): noise of 0.3 edges has less.
constexpr double kNoisyArea = 1.25;

/// Where F^(1/4) leaves less of the area, which may be its own error, the part does not move.
constexpr double kLeastArea = 1e-2;

/// If no part needs a larger factor, none loses half of its area: nothing needs to be kept.
constexpr double kWorthwhile = 2.0;

/// Factor with which nothing moves.
constexpr double kMaxFactor = 1e6;

/// Replaces values by `of` all values at the neighbours of a vertex and its own.
template <typename Reduction>
Eigen::VectorXd overRing(const SparseMatrix& W, const Eigen::VectorXd& values,
                         const Reduction& of) {
    Eigen::VectorXd result(values.size());
    parallelRows(values.size(), [&](Index begin, Index end) {
        for (Index j = begin; j < end; ++j) {
            double value = values[j];
            for (SparseMatrix::InnerIterator entry(W, j); entry; ++entry)
                if (entry.row() != j) value = of(value, values[entry.row()]);
            result[j] = value;
        }
    });
    return result;
}

}  // namespace

Eigen::ArrayXd logAreasAround(const SparseMatrix& W, const Faces& F, const Vertices& X) {
    const Eigen::VectorXd area = overRing(W, lumpedMass(X, F), std::plus<>());
    return area.array().max(std::numeric_limits<double>::min()).log();
}

ThinParts thinPartFactors(const SparseMatrix& W, const Faces& F, const Vertices& X,
                          const Vertices& weak, const Vertices& whole,
                          const ThinPartsOfTile* tile) {
    const Eigen::ArrayXd before = logAreasAround(W, F, X), quarter = logAreasAround(W, F, weak),
                         after = logAreasAround(W, F, whole);
    const auto logOfLoss = [&](Index i) {
        return std::max((quarter[i] - after[i]) * 4.0 / 3.0,
                        (before[i] - quarter[i] - std::log(kNoisyArea)) * 4.0);
    };
    Eigen::VectorXd factors(X.rows());
    for (Index i = 0; i < factors.size(); ++i)
        factors[i] = before[i] - quarter[i] > -std::log(kLeastArea)
                         ? kMaxFactor
                         : std::max(logOfLoss(i) / -std::log(kKeptArea), 1.0);
    double largest = 1.0;
    for (Index i = 0; i < factors.size(); ++i)
        if (tile == nullptr || tile->inner[i]) largest = std::max(largest, factors[i]);
    const bool areKept = tile == nullptr ? largest > kWorthwhile : tile->areKept;
    if (!areKept) return {{}, largest};
    return {overRing(W, factors, [](double a, double b) { return std::max(a, b); }), largest};
}

double keepThinParts(LaplacianBuilder& laplacians, StepEvaluator& evaluate, const Vertices& X,
                     const ThinPartsOfTile* tile, const Progress& progress) {
    laplacians.reset();
    const std::vector<Eigen::MatrixXd> powers =
        evaluate.predict(laplacians.current(), X, {1.0, 0.25}, progress).Y;
    ThinParts parts =
        thinPartFactors(laplacians.current().W, laplacians.faces(), X, powers[1], powers[0], tile);
    if (parts.factors.size() > 0) laplacians.scaleMass(std::move(parts.factors));
    return parts.largest;
}

}  // namespace spectral
