#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/graph/face_graph.h"
#include "core/support/threads.h"
#include "core/support/types.h"

namespace spectral {

/// Calls visit(i, mean of the rows of X at the neighbours of vertex i), in parallel, for every
/// vertex that has neighbours: the rows of P X, where L = I - P is the uniform Laplacian,
/// or one with the weights of the graph.
template <class Rows, class Visit>
void forEachMean(const VertexGraph& graph, const Rows& X, const Visit& visit) {
    parallelRows(graph.size(), [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) {
            const Index first = graph.first[i], last = graph.first[i + 1];
            if (first == last) continue;
            Eigen::Matrix<double, 1, Rows::ColsAtCompileTime> sum = X.row(graph.at[first]);
            if (graph.weight.empty()) {
                for (Index k = first + 1; k < last; ++k) sum += X.row(graph.at[k]);
                sum /= static_cast<double>(last - first);
            } else {
                sum *= graph.weight[first];
                for (Index k = first + 1; k < last; ++k)
                    sum += graph.weight[k] * X.row(graph.at[k]);
            }
            visit(i, sum);
        }
    });
}

/// One step of lazy diffusion, X <- (X + P X) / 2. Damps all frequencies without oscillation.
template <class Rows>
void diffuse(const VertexGraph& graph, Rows& X) {
    Rows next = X;
    forEachMean(graph, X,
                [&](Index i, const auto& mean) { next.row(i) = 0.5 * (X.row(i) + mean); });
    X.swap(next);
}

/// Independent bits for each of n positions. They are drawn by position, so that nothing depends on
/// the numbering of the vertices, nor on the unit and the place of the mesh.
std::vector<std::uint64_t> randomBits(const Points& X);

/// Positions, and columns of white noise of height 1 that undergo the same.
template <int kProbes>
using Probed = Eigen::Matrix<double, Eigen::Dynamic, 3 + kProbes, Eigen::RowMajor>;

/// Positions with probes: random signs of randomBits, whose energies after a filter vary least from
/// draw to draw (Hutchinson 1990).
template <int kProbes>
Probed<kProbes> withProbes(const Points& X) {
    const std::vector<std::uint64_t> bits = randomBits(X);
    Probed<kProbes> rows(X.rows(), 3 + kProbes);
    for (Index i = 0; i < X.rows(); ++i) {
        rows.row(i).template head<3>() = X.row(i);
        for (int k = 0; k < kProbes; ++k)
            rows(i, 3 + k) = (bits[i] >> (63 - k) & 1) == 0 ? 1.0 : -1.0;
    }
    return rows;
}

}  // namespace spectral
