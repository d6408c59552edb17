#include "core/noise/spikes.h"

#include <algorithm>
#include <cmath>

#include "core/graph/diffusion.h"
#include "core/graph/robust_statistics.h"
#include "core/noise/noise_estimate.h"

namespace spectral {

namespace {

/// L = I - P and its transpose, on scalars.
class UniformLaplacian {
  public:
    explicit UniformLaplacian(const VertexGraph& graph)
        : graph_(graph), squaredNorm_(graph.size()) {
        for (Index j = 0; j < graph.size(); ++j) {
            squaredNorm_[j] = 1.0;
            for (Index k = graph.first[j]; k < graph.first[j + 1]; ++k)
                squaredNorm_[j] += std::pow(static_cast<double>(graph.degree(graph.at[k])), -2);
        }
    }

    /// Residual along the normals, (L X) . N.
    Eigen::VectorXd residual(const Points& X, const Points& N) const {
        Eigen::VectorXd r = Eigen::VectorXd::Zero(X.rows());
        forEachMean(graph_, X, [&](Index i, const Eigen::RowVector3d& mean) {
            r[i] = (X.row(i) - mean).dot(N.row(i));
        });
        return r;
    }

    Eigen::VectorXd times(const Eigen::VectorXd& x) const {
        Eigen::VectorXd y = x;
        forEachMean(graph_, x, [&](Index i, const auto& mean) { y[i] -= mean[0]; });
        return y;
    }

    Eigen::VectorXd transposedTimes(const Eigen::VectorXd& x) const {
        Eigen::VectorXd y = x;
        parallelRows(graph_.size(), [&](Index begin, Index end) {
            for (Index i = begin; i < end; ++i)
                for (Index k = graph_.first[i]; k < graph_.first[i + 1]; ++k)
                    y[i] -= x[graph_.at[k]] / static_cast<double>(graph_.degree(graph_.at[k]));
        });
        return y;
    }

    /// |L e_j|^2
    const Eigen::VectorXd& squaredNorm() const { return squaredNorm_; }

  private:
    const VertexGraph& graph_;
    Eigen::VectorXd squaredNorm_;
};

/// Heights of the spikes, 0 elsewhere: the least-squares solution of L z = r, by conjugate
/// gradients on the normal equations.
Eigen::VectorXd heightsOf(const std::vector<bool>& isSpike, const UniformLaplacian& L,
                          const Eigen::VectorXd& r) {
    constexpr int kMaxIterationsOfHeights = 100;
    constexpr double kAccuracyOfHeights = 1e-6;
    const auto restricted = [&](Eigen::VectorXd x) {
        for (Index i = 0; i < x.size(); ++i)
            if (!isSpike[i]) x[i] = 0.0;
        return x;
    };
    Eigen::VectorXd z = Eigen::VectorXd::Zero(r.size());
    Eigen::VectorXd residual = restricted(L.transposedTimes(r)), direction = residual;
    double squared = residual.squaredNorm();
    const double tolerance = kAccuracyOfHeights * kAccuracyOfHeights * squared;
    for (int k = 0; k < kMaxIterationsOfHeights && squared > tolerance; ++k) {
        const Eigen::VectorXd image = L.times(direction);
        const double curvature = image.squaredNorm();
        if (!(curvature > 0.0)) break;  // all vertices of a component are spikes
        const double step = squared / curvature;
        z += step * direction;
        residual -= step * restricted(L.transposedTimes(image));
        const double next = residual.squaredNorm();
        direction = residual + next / squared * direction;
        squared = next;
    }
    return z;
}

/// Drops spikes with at least two more neighbouring spikes on their own side than on the other.
void dropClusters(const VertexGraph& graph, const Eigen::VectorXd& height,
                  std::vector<bool>& isSpike) {
    constexpr int kCluster = 2;
    const std::vector<bool> wasSpike = isSpike;
    for (Index i = 0; i < graph.size(); ++i) {
        int sameSide = 0;
        for (Index k = graph.first[i]; wasSpike[i] && k < graph.first[i + 1]; ++k)
            if (wasSpike[graph.at[k]]) sameSide += height[i] * height[graph.at[k]] > 0.0 ? 1 : -1;
        if (sameSide >= kCluster) isSpike[i] = false;
    }
}

}  // namespace

Spikes findSpikes(const FaceGraph& graph, const Points& X, const std::vector<bool>& mayMove,
                  double deviations, double meanEdge) {
    constexpr int kMaxSearches = 12, kSearchBlurs = 4;
    constexpr double kMinSpike = 0.1;   // mean edges
    constexpr double kMinFound = 1e-4;  // share of the vertices that makes another round worthwhile
    const UniformLaplacian L(graph.vertices);
    const VertexGraph& vertices = graph.vertices;
    Points without = X;
    std::vector<bool> isSpike(mayMove.size(), false);
    for (int round = 0; round < kMaxSearches; ++round) {
        const Points N = smoothVertexNormals(graph, without, kSearchBlurs);
        const Eigen::VectorXd d =
            L.transposedTimes(L.residual(without, N)).cwiseQuotient(L.squaredNorm());
        std::vector<double> moduli;
        for (Index i = 0; i < d.size(); ++i)
            if (mayMove[i]) moduli.push_back(std::abs(d[i]));
        const double threshold =
            std::max(deviations * medianDeviation(std::move(moduli)), kMinSpike * meanEdge);
        Index found = 0;
        for (Index i = 0; i < d.size(); ++i) {
            if (!mayMove[i] || !(std::abs(d[i]) > threshold)) continue;
            bool isLargest = true;
            for (Index k = vertices.first[i]; k < vertices.first[i + 1]; ++k)
                isLargest = isLargest && std::abs(d[i]) >= std::abs(d[vertices.at[k]]);
            if (!isLargest) continue;
            isSpike[i] = true;
            without.row(i) -= d[i] * N.row(i);
            ++found;
        }
        if (static_cast<double>(found) < std::max(1.0, kMinFound * static_cast<double>(d.size())))
            break;
    }
    Spikes spikes;
    spikes.N = smoothVertexNormals(graph, without);
    const Eigen::VectorXd r = L.residual(X, spikes.N);
    dropClusters(vertices, heightsOf(isSpike, L, r), isSpike);
    spikes.height = heightsOf(isSpike, L, r);
    spikes.count = (spikes.height.array() != 0.0).count();
    return spikes;
}

Spikes certainSpikes(const FaceGraph& graph, const Points& X, Spikes spikes, double meanEdge) {
    constexpr double kMinCertainSpike = 1.5;  // mean edges of the mesh and, without it, of its own
    constexpr double kMinExplained = 0.97;
    const UniformLaplacian L(graph.vertices);
    const Eigen::VectorXd r = L.residual(X, spikes.N), rest = r - L.times(spikes.height);
    const VertexGraph& vertices = graph.vertices;
    const Points without = X - spikes.height.asDiagonal() * spikes.N;
    for (Index i = 0; i < r.size(); ++i) {
        if (spikes.height[i] == 0.0) continue;
        double before = r[i] * r[i], after = rest[i] * rest[i], length = 0.0;
        for (Index k = vertices.first[i]; k < vertices.first[i + 1]; ++k) {
            const int other = vertices.at[k];
            before += r[other] * r[other];
            after += rest[other] * rest[other];
            length += (without.row(i) - without.row(other)).norm();
        }
        const double edge = std::max(
            meanEdge, length / static_cast<double>(std::max<Index>(vertices.degree(i), 1)));
        if (!(std::abs(spikes.height[i]) > kMinCertainSpike * edge &&
              after < (1.0 - kMinExplained) * before))
            spikes.height[i] = 0.0;
    }
    spikes.count = (spikes.height.array() != 0.0).count();
    return spikes;
}

}  // namespace spectral
