#include "core/laplacian/intrinsic_delaunay.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/support/threads.h"

namespace spectral {

namespace {

/// Mollification: two sides of a triangle exceed the third by at least this many mean edge lengths,
/// as in Sharp and Crane, or, in a needle, by at least this share of its shortest side: a needle
/// with a wide angle is not degenerate, and longer sides would make it another surface. Below
/// kPoint mean edges a side is taken for a point: the weights along and across such needles differ
/// by the square of that, and a row of W could not hold both.
constexpr double kMollification = 1e-5, kShareOfNeedle = 0.1, kPoint = 1e-7;

/// Sorts the sides of one edge by the angles of their triangles around it.
void sortByAngle(const Vertices& V, const Faces& F, std::vector<Side>& sides) {
    const Eigen::RowVector3d origin = V.row(sides.front().low);
    const Eigen::RowVector3d axis = (V.row(sides.front().high) - origin).normalized();
    const Eigen::RowVector3d right = axis.unitOrthogonal(), up = axis.cross(right);
    const auto angle = [&](const Side& s) {
        const Eigen::RowVector3d spoke = V.row(F(s.face(), s.opposite())) - origin;
        const double theta = std::atan2(spoke.dot(up), spoke.dot(right));
        return std::isfinite(theta) ? theta : 0.0;  // an edge of length zero has no angles
    };
    // Duplicate triangles have equal angles. They are stacked in the same order at all three edges,
    // by index along the normal of their sorted corners, so that the sheets do not cross.
    const auto layer = [&](const Side& s) {
        const int opposite = F(s.face(), s.opposite());
        const bool againstNormal = s.low < opposite && opposite < s.high;
        return againstNormal ? -s.number : s.number;
    };
    std::sort(sides.begin(), sides.end(), [&](const Side& a, const Side& b) {
        return std::pair(angle(a), layer(a)) < std::pair(angle(b), layer(b));
    });
}

/// The cotangent matrix of an intrinsic triangulation: W_ij = -weight, W_ii = -sum_j W_ij; zero
/// weights are stored, too.
/// @param copies  number of copies of every triangle in the cover.
SparseMatrix stiffnessOf(const IntrinsicTriangulation& triangulation, int copies,
                         Index vertexCount) {
    // Column j has room for one entry per side that starts at j, and the diagonal.
    const auto n = static_cast<std::size_t>(vertexCount);
    std::vector<int> begin(n + 1, 1);
    begin[0] = 0;
    forEachInOrder(triangulation.sideCount(),
                   [&](Index s) { ++begin[triangulation.tail(static_cast<int>(s)) + 1]; });
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    SparseMatrix W(vertexCount, vertexCount);
    W.resizeNonZeros(begin.back());
    int* rows = W.innerIndexPtr();
    std::vector<int> end(begin.begin(), begin.end() - 1);
    forEachInOrder(triangulation.sideCount(), [&](Index s) {
        const int side = static_cast<int>(s);
        rows[end[triangulation.tail(side)]++] = side;
    });

    parallelRows(vertexCount, [&](Index first, Index last) {
        struct Entry {
            int row;
            double value;
        };
        std::vector<Entry> entries;
        for (int j = static_cast<int>(first); j < last; ++j) {
            entries.assign(1, {j, 0.0});
            for (int p = begin[j]; p < end[j]; ++p) {
                const int s = rows[p], i = triangulation.tail(triangulation.twin(s));
                if (i == j) continue;  // a loop
                const double weight = 0.5 / copies * std::max(0.0, triangulation.edgeCotangents(s));
                entries.front().value += weight;
                entries.push_back({i, -weight});
            }
            // Sorted by value, too: W_ij and W_ji are summed in the same order, so W is exactly
            // symmetric.
            std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
                return std::pair(a.row, a.value) < std::pair(b.row, b.value);
            });
            int at = begin[j] - 1;
            for (const Entry& entry : entries)  // several edges may join i and j
                if (at >= begin[j] && rows[at] == entry.row) {
                    W.valuePtr()[at] += entry.value;
                } else {
                    rows[++at] = entry.row;
                    W.valuePtr()[at] = entry.value;
                }
            end[j] = at + 1;
        }
    });
    // Close the gaps that merged entries leave between columns.
    int* starts = W.outerIndexPtr();
    for (std::size_t j = 0; j < n; ++j) {
        const int size = end[j] - begin[j];
        starts[j + 1] = starts[j] + size;
        if (starts[j] == begin[j]) continue;
        std::copy_n(rows + begin[j], size, rows + starts[j]);
        std::copy_n(W.valuePtr() + begin[j], size, W.valuePtr() + starts[j]);
    }
    W.resizeNonZeros(starts[n]);
    return W;
}

}  // namespace

IntrinsicDelaunay::IntrinsicDelaunay(const Vertices& V, const Faces& F, const SidesByEdge& edges)
    : vertexCount_(V.rows()) {
    const int front = static_cast<int>(3 * F.rows());
    const auto runsUp = [&](const Side& s) { return F(s.face(), s.corner()) == s.low; };
    std::atomic<bool> closedAndOriented = true;
    edges.forEachEdgeInParallel([&](const Side* first, const Side* last) {
        if (last - first != 2 || runsUp(first[0]) == runsUp(first[1])) closedAndOriented = false;
    });
    copies_ = closedAndOriented ? 1 : 2;

    tail_.resize(static_cast<std::size_t>(copies_) * front);
    twin_.resize(tail_.size());
    first_.resize(front);
    for (int s = 0; s < front; ++s) tail_[s] = F(s / 3, s % 3);

    // The back of a triangle (a, b, c) is (a, c, b): its side 2 - s lies on side s of the front.
    const auto back = [front](int side) { return front + 3 * (side / 3) + 2 - side % 3; };
    if (copies_ == 2)
        for (int s = 0; s < front; ++s) tail_[back(s)] = F(s / 3, (s + 1 - 3 * (s / 3)) % 3);
    edges.forEachEdgeInParallel([&](const Side* first, const Side* last) {
        first_[first->number] = 1;
        std::vector<Side> around;
        if (last - first > 2) {
            around.assign(first, last);
            sortByAngle(V, F, around);
            first = around.data();
            last = first + around.size();
        }
        // The copy that runs up the edge faces larger angles: it is glued to the copy of the next
        // triangle that runs down. The triangle of a boundary edge is glued to its own back.
        for (const Side* here = first; here != last; ++here) {
            const Side* there = here + 1 != last ? here + 1 : first;
            const int up = runsUp(*here) ? here->number : back(here->number);
            if (copies_ == 1 && up >= front) continue;
            const int down = runsUp(*there) ? back(there->number) : there->number;
            twin_[up] = down;
            twin_[down] = up;
        }
    });
}

IntrinsicTriangulation IntrinsicDelaunay::triangulation(const Vertices& V) && {
    std::vector<double> length(tail_.size());
    parallelRows(static_cast<Index>(tail_.size()), [&](Index begin, Index end) {
        for (Index s = begin; s < end; ++s)
            length[s] = (V.row(tail_[nextSide(static_cast<int>(s))]) - V.row(tail_[s])).norm();
    });

    // The smallest mollification that makes every triangle inequality hold by the margin.
    const double edgeCount = std::accumulate(first_.begin(), first_.end(), 0.0);
    const double meanLength =
        std::inner_product(first_.begin(), first_.end(), length.begin(), 0.0) / edgeCount;
    const auto margin = [&](double shortest) {
        const double usual = kMollification * meanLength;
        return shortest > kPoint * meanLength ? std::min(usual, kShareOfNeedle * shortest) : usual;
    };
    const double epsilon =
        parallelMax(static_cast<Index>(length.size()), [&](Index begin, Index end) {
            double largest = 0.0;
            for (int s = static_cast<int>(begin); s < end; ++s) {
                const double a = length[s], b = length[nextSide(s)], c = length[previousSide(s)];
                largest = std::max(largest, a - b - c + margin(std::min({a, b, c})));
            }
            return largest;
        });
    if (epsilon > 0.0)
        for (double& l : length) l += epsilon;

    IntrinsicTriangulation triangulation(std::move(tail_), std::move(twin_), std::move(length));
    triangulation.makeDelaunay();
    return triangulation;
}

SparseMatrix IntrinsicDelaunay::stiffness(const Vertices& V) && {
    return stiffnessOf(std::move(*this).triangulation(V), copies_, vertexCount_);
}

}  // namespace spectral
