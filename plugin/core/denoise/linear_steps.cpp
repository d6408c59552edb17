#include "core/denoise/linear_steps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "core/denoise/whiteness.h"
#include "core/graph/diffusion.h"
#include "core/graph/local_average.h"
#include "core/graph/robust_statistics.h"
#include "core/krylov/chebyshev_series.h"
#include "core/noise/noise_estimate.h"

namespace spectral {

namespace {

/// Positions, and white noise that undergoes the same steps.
using Shapes = Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>;

/// Numbers of steps to try, and the stage whose normals are taken.
constexpr std::array<int, 11> kSteps{5, 10, 14, 20, 28, 40, 56, 80, 113, 160, 226};
constexpr std::size_t kStageOfNormals = 3;

/// Chebyshev coefficients of `count` steps in P, where L = I - P: the gain is flat where P is near
/// 1, and 20 steps need ten products, not 40.
std::vector<double> coefficientsOf(int count) {
    constexpr double kAccuracy = 1e-4;
    constexpr int kNodes = 64;
    const ChebyshevSeries series(
        [&](double p) {
            return std::pow((1.0 - 0.6 * (1.0 - p)) * (1.0 + 0.61 * (1.0 - p)), count);
        },
        -1.0, 1.0, kNodes);
    std::vector<double> c = series.coefficients();
    c.resize(static_cast<std::size_t>(std::max(series.lengthFor(kAccuracy), 2)));
    c[0] += 1.0 - std::accumulate(c.begin(), c.end(), 0.0);  // a place stays
    return c;
}

void takeSteps(const VertexGraph& graph, int count, Shapes& X) {
    const std::vector<double> c = coefficientsOf(count);
    Shapes before = X, here = X, next = X;
    forEachMean(graph, before, [&](Index i, const auto& mean) {
        here.row(i) = mean;
        X.row(i) = c[0] * before.row(i) + c[1] * mean;
    });
    for (std::size_t j = 2; j < c.size(); ++j) {
        forEachMean(graph, here, [&](Index i, const auto& mean) {
            next.row(i) = 2.0 * mean - before.row(i);
            X.row(i) += c[j] * next.row(i);
        });
        before.swap(here);
        here.swap(next);
    }
}

/// Squared difference to the neighbours, on average, at every vertex, of each column of Y.
template <class Columns>
Columns squaredSlopes(const VertexGraph& graph, const Columns& Y) {
    Columns slopes = Columns::Zero(Y.rows(), Y.cols());
    parallelRows(Y.rows(), [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) {
            for (Index k = graph.first[i]; k < graph.first[i + 1]; ++k)
                slopes.row(i) += (Y.row(i) - Y.row(graph.at[k])).cwiseAbs2();
            slopes.row(i) /= static_cast<double>(std::max<Index>(graph.degree(i), 1));
        }
    });
    return slopes;
}

/// Averages over the place of each vertex, or over all vertices of a map that is alike everywhere.
class Average {
  public:
    /// @param counts  n: whether a vertex counts; kept by reference.
    Average(const VertexGraph& graph, const std::vector<bool>& counts, int steps, bool isOfAll)
        : counts_(counts) {
        if (!isOfAll) place_.emplace(graph, counts, steps);
    }

    /// Average of each column of Y, n x C.
    template <class Columns>
    Columns of(Columns Y) const {
        if (place_) return place_->of(std::move(Y));
        Eigen::Matrix<double, 1, Columns::ColsAtCompileTime> sum = 0.0 * Y.row(0);
        double count = 0.0;
        for (Index i = 0; i < Y.rows(); ++i) {
            if (!counts_[i]) continue;
            sum += Y.row(i);
            count += 1.0;
        }
        Y.rowwise() = sum / std::max(count, 1.0);
        return Y;
    }

  private:
    const std::vector<bool>& counts_;
    std::optional<LocalAverage> place_;
};

/// Least share of slopes and of noise, to divide by.
constexpr double kTiny = 1e-300;

/// The stages of the steps, and which of them has least error in each place.
struct Stages {
    std::vector<Shapes> shapes;
    std::size_t count = 0;  ///< Those that are better somewhere than all before.
    Eigen::VectorXd best;   ///< n: index of the stage, between two of them as well.
    Eigen::VectorXd error;  ///< n: of the slopes, relative to those of the noise.
};

Stages takeStages(const FaceGraph& graph, const VertexGraph& averaged, const Points& X,
                  const std::vector<bool>& mayMove, const NoiseField& noise) {
    constexpr int kErrors = 32, kCounts = 16;  // steps of averages
    using Slopes = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
    const Index n = X.rows();
    std::vector<bool> counts(mayMove);
    for (Index i = 0; i < n; ++i) counts[i] = mayMove[i] && !graph.onRim[i];
    const Average average(graph.vertices, counts, kErrors, noise.isAlike());
    const Eigen::VectorXd white = withProbes<1>(X).col(3).cwiseProduct(noise.height);
    const Eigen::VectorXd whiteSlope =
        average.of(squaredSlopes(graph.vertices, white)).cwiseMax(kTiny);
    Shapes start(n, 4);
    start << X, white;
    Stages stages;
    const auto shapeAt = [&](std::size_t stage) -> const Shapes& {
        for (std::size_t k = stages.shapes.size(); k <= stage; ++k) {
            stages.shapes.push_back(k == 0 ? start : stages.shapes.back());
            takeSteps(averaged, k == 0 ? kSteps[0] : kSteps[k] - kSteps[k - 1],
                      stages.shapes.back());
        }
        return stages.shapes[stage];
    };
    // The same normals for all steps, so that a change of normals is not mistaken for shape.
    const Points N = smoothVertexNormals(graph, shapeAt(kStageOfNormals).leftCols<3>(), 1);

    Eigen::VectorXd least, first;
    stages.best.setZero(n);
    for (; stages.count < kSteps.size(); ++stages.count) {
        const Shapes& Y = shapeAt(stages.count);
        Slopes slopes(n, 3);  // of the displacement, of what is taken from noise, and left of it
        slopes.col(0) = (Y.leftCols<3>() - X).cwiseProduct(N).rowwise().sum();
        slopes.col(1) = white - Y.col(3);
        slopes.col(2) = Y.col(3);
        slopes = average.of(squaredSlopes(graph.vertices, slopes));
        const Eigen::VectorXd fromNoise = slopes.col(1).cwiseMax(kTiny);
        const Eigen::VectorXd ratio = slopes.col(0).cwiseQuotient(fromNoise);
        const bool isFirst = stages.count == 0;
        if (isFirst) first = ratio.cwiseMax(kTiny);  // the first steps remove only noise
        const Eigen::VectorXd error =
            ((ratio.cwiseQuotient(first).array() - 1.0).max(0.0) * fromNoise.array() +
             slopes.col(2).array()) /
            whiteSlope.array();
        bool isBetter = isFirst;
        if (isFirst) least = error;
        for (Index i = 0; i < n; ++i)
            if (mayMove[i] && error[i] < least[i]) {
                least[i] = error[i];
                stages.best[i] = static_cast<double>(stages.count);
                isBetter = true;
            }
        if (!isBetter) break;
    }
    stages.best = Average(graph.vertices, mayMove, kCounts, noise.isAlike()).of(stages.best);
    stages.error = least.cwiseSqrt();
    return stages;
}

/// The shape of each place at its best stage.
Points shapeOf(const Stages& stages, const Points& X, const std::vector<bool>& mayMove) {
    Points shape = X;
    const double last = static_cast<double>(stages.count) - 1.0;
    for (Index i = 0; i < X.rows(); ++i) {
        if (!mayMove[i]) continue;
        const double best = std::clamp(stages.best[i], 0.0, last);
        const auto low = static_cast<std::size_t>(best), high = std::min(low + 1, stages.count - 1);
        const double fraction = best - static_cast<double>(low);
        const Eigen::RowVector4d at =
            (1.0 - fraction) * stages.shapes[low].row(i) + fraction * stages.shapes[high].row(i);
        shape.row(i) = at.head<3>();
    }
    return shape;
}

/// Whether the noise lies in all directions, not along the normals: whether the residuals within
/// the surface are louder where it is higher. Those of an irregular mesh are alike everywhere.
bool hasAllDirections(const VertexGraph& graph, const Points& X, const Points& N,
                      const NoiseField& noise) {
    // Of what such noise would make: up to .01 where noise is along normals, .59 and more where it
    // is not.
    constexpr double kMinRise = 0.3;
    constexpr double kMedianOfTwo = 1.386;  // squared length of a normal distribution in a plane
    const Eigen::VectorXd squares = noise.height.cwiseQuotient(noise.edge).cwiseAbs2();
    std::vector<double> heights;
    for (const double square : squares)
        if (square > 0.0) heights.push_back(square);
    const double middle = quantile(std::move(heights), 0.5);
    std::array<std::vector<double>, 2> within, along;  // where it is lower, and higher
    Eigen::VectorXd tangential = Eigen::VectorXd::Zero(X.rows());
    forEachMean(graph, X, [&](Index i, const Eigen::RowVector3d& mean) {
        const Eigen::RowVector3d residual = X.row(i) - mean;
        tangential[i] = (residual.squaredNorm() - std::pow(residual.dot(N.row(i)), 2)) /
                        (1.0 + 1.0 / static_cast<double>(graph.degree(i)));
    });
    for (Index i = 0; i < X.rows(); ++i) {
        const bool isHigh = squares[i] >= middle;
        within[isHigh].push_back(tangential[i] / (noise.edge[i] * noise.edge[i]));
        along[isHigh].push_back(squares[i]);
    }
    const auto rise = [](std::array<std::vector<double>, 2>& values) {
        return quantile(std::move(values[1]), 0.5) - quantile(std::move(values[0]), 0.5);
    };
    return rise(within) > kMinRise * kMedianOfTwo * rise(along);
}

}  // namespace

VertexGraph averagedNeighbours(const FaceGraph& graph, const VertexGraph& means,
                               const std::vector<bool>& mayMove) {
    VertexGraph averaged;
    averaged.first.push_back(0);
    for (Index i = 0; i < means.size(); ++i) {
        double sum = 0.0;
        for (Index k = means.first[i]; k < means.first[i + 1]; ++k) {
            if (!mayMove[i] || (graph.onRim[i] && !graph.onRim[means.at[k]])) continue;
            averaged.at.push_back(means.at[k]);
            if (means.weight.empty()) continue;
            averaged.weight.push_back(means.weight[k]);
            sum += means.weight[k];
        }
        for (std::size_t k = averaged.first.back(); k < averaged.weight.size(); ++k)
            averaged.weight[k] /= sum;
        averaged.first.push_back(static_cast<Index>(averaged.at.size()));
    }
    return averaged;
}

LinearSteps linearSteps(const FaceGraph& graph, const VertexGraph& means, const Points& X,
                        const std::vector<bool>& mayMove, const NoiseField& noise, bool isTailed) {
    // Error of the slopes, relative to those of the noise, that the normal filter achieves.
    constexpr double kMaxError = 0.17, kOfHeight = 0.2, kMaxErrorTailed = 0.19;
    constexpr double kMargin = 1.15, kFadingError = 0.03;
    constexpr double kWeakForRounds = 0.07;  // rounds hardly remove weaker noise
    constexpr double kMaxTail = 1.1, kNoTail = 1.02;
    constexpr int kShares = 8;  // steps of averages
    const Index n = X.rows();
    const Stages stages =
        takeStages(graph, averagedNeighbours(graph, means, mayMove), X, mayMove, noise);
    LinearSteps result;
    result.steps = kSteps[stages.count - 1];
    result.X = shapeOf(stages, X, mayMove);
    result.N = areaNormals(result.X, graph.F);
    normalizeRows(result.N);
    const Points N = smoothVertexNormals(graph, result.X, 1);
    const Eigen::VectorXd along = (result.X - X).cwiseProduct(N).rowwise().sum();
    const bool isAlike = noise.isAlike();
    if (isAlike || !hasAllDirections(graph.vertices, X, N, noise))
        result.X = X + along.asDiagonal() * N;
    // Shapes with creases move far in places.
    const double heaviness = isAlike ? tail(graph.vertices, along) : 1.0;
    const bool isEven = isTailed || heaviness < kMaxTail;
    result.share.setZero(n);
    for (Index i = 0; i < n; ++i) {
        if (!mayMove[i]) continue;
        const double height = noise.height[i] / noise.edge[i];
        const double limit = isTailed ? kMaxErrorTailed : kMaxError - kOfHeight * height;
        if (isAlike) {
            result.share[i] =
                (isEven && stages.error[i] < limit) || heaviness < kNoTail ? 1.0 : 0.0;
            continue;
        }
        const double weakness = std::max(1.0, kWeakForRounds / height);
        result.share[i] =
            std::clamp((kMargin * weakness * limit - stages.error[i]) / kFadingError, 0.0, 1.0);
    }
    result.share = Average(graph.vertices, mayMove, kShares, isAlike).of(result.share);
    double moving = 0.0, rejected = 0.0;
    for (Index i = 0; i < n; ++i) {
        result.share[i] = mayMove[i] ? std::clamp(2.0 * result.share[i] - 0.5, 0.0, 1.0) : 0.0;
        moving += mayMove[i];
        rejected += mayMove[i] && result.share[i] < 1.0;
    }
    result.rejected = moving > 0.0 ? rejected / moving : 0.0;
    return result;
}

}  // namespace spectral
