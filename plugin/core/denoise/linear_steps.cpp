#include "core/denoise/linear_steps.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/denoise/whiteness.h"
#include "core/graph/diffusion.h"
#include "core/graph/local_average.h"

namespace spectral {

namespace {

/// Positions, and white noise that undergoes the same steps.
using Rows = Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>;

/// Numbers of steps to try, and those before the normals are taken.
constexpr std::array<int, 11> kSteps{5, 10, 14, 20, 28, 40, 56, 80, 113, 160, 226};
constexpr int kStepsToNormals = 20;

void takeSteps(const VertexGraph& graph, int count, Rows& X) {
    Rows next = X;
    for (int k = 0; k < count; ++k)
        for (const double factor : {0.6, -0.61}) {
            forEachMean(graph, X, [&](Index i, const auto& mean) {
                next.row(i) = (1.0 - factor) * X.row(i) + factor * mean;
            });
            X.swap(next);
        }
}

/// Mean squared difference along the edges without a vertex on the rim.
double squaredSlope(const FaceGraph& graph, const Eigen::VectorXd& y) {
    const VertexGraph& vertices = graph.vertices;
    const Eigen::Array2d sums =
        parallelSum(vertices.size(), Eigen::Array2d(0.0, 0.0), [&](Index begin, Index end) {
            Eigen::Array2d sum(0.0, 0.0);
            for (Index i = begin; i < end; ++i)
                for (Index k = vertices.first[i]; k < vertices.first[i + 1]; ++k) {
                    const int j = vertices.at[k];
                    if (graph.onRim[i] || graph.onRim[j]) continue;
                    sum += Eigen::Array2d(std::pow(y[i] - y[j], 2), 1.0);
                }
            return sum;
        });
    return sums[1] > 0.0 ? sums[0] / sums[1] : 0.0;
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

Points smoothNormals(const FaceGraph& graph, const Points& X) {
    return vertexNormals(graph, blurredNormals(graph, areaNormals(X, graph.F), 1));
}

}  // namespace

VertexGraph averagedNeighbours(const FaceGraph& graph, const std::vector<bool>& mayMove) {
    VertexGraph averaged;
    averaged.first.push_back(0);
    const VertexGraph& all = graph.vertices;
    for (Index i = 0; i < all.size(); ++i) {
        double sum = 0.0;
        for (Index k = all.first[i]; k < all.first[i + 1]; ++k) {
            if (!mayMove[i] || (graph.onRim[i] && !graph.onRim[all.at[k]])) continue;
            averaged.at.push_back(all.at[k]);
            if (all.weight.empty()) continue;
            averaged.weight.push_back(all.weight[k]);
            sum += all.weight[k];
        }
        for (std::size_t k = averaged.first.back(); k < averaged.weight.size(); ++k)
            averaged.weight[k] /= sum;
        averaged.first.push_back(static_cast<Index>(averaged.at.size()));
    }
    return averaged;
}

std::optional<LinearSteps> linearSteps(const FaceGraph& graph, const Points& X,
                                       const std::vector<bool>& mayMove, double height,
                                       bool isTailed) {
    // Error of the slopes, relative to those of the noise, that the normal filter achieves.
    const double maxError = isTailed ? 0.19 : 0.17 - 0.2 * height;
    constexpr double kMaxTail = 1.1, kNoTail = 1.02;
    const VertexGraph averaged = averagedNeighbours(graph, mayMove);
    const Eigen::VectorXd white = whiteNoise(X.rows());
    const double whiteSlope = squaredSlope(graph, white);
    Rows start(X.rows(), 4);
    start << X, white;

    Rows Y = start;
    takeSteps(averaged, kStepsToNormals, Y);
    // The same normals for all steps, so that a change of normals is not mistaken for shape.
    const Points N = smoothNormals(graph, Y.leftCols<3>());
    Y = start;
    LinearSteps best;
    double least = 0.0, noise = 0.0;  // squared error, and squared height of the noise
    int taken = 0;
    for (const int steps : kSteps) {
        takeSteps(averaged, steps - taken, Y);
        taken = steps;
        const Eigen::VectorXd along = (Y.leftCols<3>() - X).cwiseProduct(N).rowwise().sum();
        const double takenFromNoise = squaredSlope(graph, white - Y.col(3));
        const double ratio = squaredSlope(graph, along) / takenFromNoise;
        if (noise == 0.0) noise = ratio;  // the first steps remove only noise
        if (!(noise > 0.0)) return std::nullopt;
        const double shape = std::max(0.0, ratio / noise - 1.0) * takenFromNoise;
        const double error = (shape + squaredSlope(graph, Y.col(3))) / whiteSlope;
        if (best.steps > 0 && error >= least) break;
        least = error;
        best.X = Y.leftCols<3>();
        best.steps = steps;
    }
    const Points ownN = smoothNormals(graph, best.X);
    const Eigen::VectorXd along = (best.X - X).cwiseProduct(ownN).rowwise().sum();
    const double heaviness = tail(graph.vertices, along);
    const bool isEven = isTailed || heaviness < kMaxTail;
    if (!(isEven && least < maxError * maxError) && !(heaviness < kNoTail)) return std::nullopt;
    best.N = areaNormals(best.X, graph.F);
    normalizeRows(best.N);
    best.X = X + along.asDiagonal() * ownN;
    return best;
}

LinearStepsByPlace linearStepsByPlace(const FaceGraph& graph, const Points& X,
                                      const std::vector<bool>& mayMove, const NoiseField& place,
                                      int maxSteps) {
    constexpr int kErrors = 32, kCounts = 16, kShares = 8;  // steps of averages
    constexpr double kMaxError = 0.17, kOfHeight = 0.2, kMargin = 1.15, kFadingError = 0.03;
    constexpr double kWeakForRounds = 0.07;  // rounds hardly remove weaker noise
    using Slopes = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
    const Index n = X.rows();
    const VertexGraph averaged = averagedNeighbours(graph, mayMove);
    const Eigen::VectorXd white = whiteNoise(n).cwiseProduct(place.height);
    const LocalAverage average(graph.vertices, mayMove, kErrors);
    const Eigen::VectorXd whiteSlope =
        average.of(squaredSlopes(graph.vertices, white)).cwiseMax(1e-300);
    Rows start(n, 4);
    start << X, white;
    Rows Y = start;
    takeSteps(averaged, kStepsToNormals, Y);
    const Points N = smoothNormals(graph, Y.leftCols<3>());

    Y = start;
    std::vector<Points> stages;
    Eigen::VectorXd least, first, best = Eigen::VectorXd::Zero(n);
    int taken = 0;
    for (const int steps : kSteps) {
        if (steps > maxSteps) break;
        takeSteps(averaged, steps - taken, Y);
        taken = steps;
        Slopes slopes(n, 3);  // of the displacement, of what is taken from noise, and left of it
        slopes.col(0) = (Y.leftCols<3>() - X).cwiseProduct(N).rowwise().sum();
        slopes.col(1) = white - Y.col(3);
        slopes.col(2) = Y.col(3);
        slopes = average.of(squaredSlopes(graph.vertices, slopes));
        const Eigen::VectorXd fromNoise = slopes.col(1).cwiseMax(1e-300);
        const Eigen::VectorXd ratio = slopes.col(0).cwiseQuotient(fromNoise);
        if (stages.empty()) first = ratio.cwiseMax(1e-300);  // the first steps remove only noise
        const Eigen::VectorXd error =
            ((ratio.cwiseQuotient(first).array() - 1.0).max(0.0) * fromNoise.array() +
             slopes.col(2).array()) /
            whiteSlope.array();
        const auto stage = static_cast<double>(stages.size());
        bool isBetter = stages.empty();
        if (stages.empty()) least = error;
        for (Index i = 0; i < n; ++i)
            if (mayMove[i] && error[i] < least[i]) {
                least[i] = error[i];
                best[i] = stage;
                isBetter = true;
            }
        if (!isBetter) break;
        stages.emplace_back(Y.leftCols<3>());
    }
    best = LocalAverage(graph.vertices, mayMove, kCounts).of(best);

    LinearStepsByPlace result{X, taken, Eigen::VectorXd::Zero(n)};
    const double last = static_cast<double>(stages.size()) - 1.0;
    for (Index i = 0; i < n; ++i) {
        if (!mayMove[i]) continue;
        const double at = std::clamp(best[i], 0.0, last);
        const auto low = static_cast<std::size_t>(at), high = std::min(low + 1, stages.size() - 1);
        const double fraction = at - static_cast<double>(low);
        result.X.row(i) = (1.0 - fraction) * stages[low].row(i) + fraction * stages[high].row(i);
        const double height = place.height[i] / place.edge[i];
        const double weakness = std::max(1.0, kWeakForRounds / height);
        const double limit = kMargin * weakness * (kMaxError - kOfHeight * height);
        result.share[i] = std::clamp((limit - std::sqrt(least[i])) / kFadingError, 0.0, 1.0);
    }
    result.share = LocalAverage(graph.vertices, mayMove, kShares).of(result.share);
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
