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

/// Mollification: two sides of a triangle are longer than the third by at least this many mean edge
/// lengths. The value of Sharp and Crane.
constexpr double kMollification = 1e-5;

/// A side of a triangle of the mesh, and its edge.
struct EdgeSide {
    int low, high;  // vertices, low < high
    int side;
    bool operator<(const EdgeSide& other) const {
        return std::pair(high, side) < std::pair(other.high, other.side);
    }
};

/// All sides, sorted by edge.
struct SidesByEdge {
    std::vector<EdgeSide> sides;
    std::vector<int> begin;  // of the sides of each lower vertex; then their number

    SidesByEdge(const Faces& F, Index vertexCount)
        : sides(static_cast<std::size_t>(3 * F.rows())),
          begin(static_cast<std::size_t>(vertexCount) + 1, 0) {
        // A bucket sort by the lower vertex, which few sides share.
        const auto forEachSide = [&F](const auto& visit) {
            forEachInOrder(F.rows(), [&](Index t) {
                for (int c = 0; c < 3; ++c) {
                    const int i = F(t, c), j = F(t, c == 2 ? 0 : c + 1);
                    visit(EdgeSide{std::min(i, j), std::max(i, j), static_cast<int>(3 * t) + c});
                }
            });
        };
        forEachSide([&](const EdgeSide& s) { ++begin[s.low + 1]; });
        std::partial_sum(begin.begin(), begin.end(), begin.begin());
        std::vector<int> next(begin.begin(), begin.end() - 1);
        forEachSide([&](const EdgeSide& s) { sides[next[s.low]++] = s; });
        parallelRows(vertexCount, [&](Index first, Index last) {
            for (Index i = first; i < last; ++i)
                std::sort(sides.begin() + begin[i], sides.begin() + begin[i + 1]);
        });
    }

    /// Calls visit(first, last) for the sides of every edge, in parallel.
    template <class Visit>
    void forEachEdge(const Visit& visit) {
        parallelRows(static_cast<Index>(begin.size()) - 1, [&](Index from, Index to) {
            EdgeSide *first = sides.data() + begin[from], *end = sides.data() + begin[to];
            while (first != end) {
                EdgeSide* last = std::find_if(first, end, [first](const EdgeSide& s) {
                    return s.low != first->low || s.high != first->high;
                });
                visit(first, last);
                first = last;
            }
        });
    }
};

/// Sorts the sides of one edge by the angles of their triangles around it.
void sortByAngle(const Vertices& V, const Faces& F, EdgeSide* first, EdgeSide* last) {
    const Eigen::RowVector3d origin = V.row(first->low);
    const Eigen::RowVector3d axis = (V.row(first->high) - origin).normalized();
    const Eigen::RowVector3d right = axis.unitOrthogonal(), up = axis.cross(right);
    const auto angle = [&](const EdgeSide& s) {
        const Eigen::RowVector3d spoke = V.row(F(s.side / 3, (s.side + 2) % 3)) - origin;
        const double theta = std::atan2(spoke.dot(up), spoke.dot(right));
        return std::isfinite(theta) ? theta : 0.0;  // an edge of length zero has no angles
    };
    // Duplicate triangles have equal angles. They are stacked in the same order at all three edges,
    // by index along the normal of their sorted corners, so that the sheets do not cross.
    const auto layer = [&](const EdgeSide& s) {
        const int opposite = F(s.side / 3, (s.side + 2) % 3);
        const bool againstNormal = s.low < opposite && opposite < s.high;
        return againstNormal ? -s.side : s.side;
    };
    std::sort(first, last, [&](const EdgeSide& a, const EdgeSide& b) {
        return std::pair(angle(a), layer(a)) < std::pair(angle(b), layer(b));
    });
}

/// The cotangent matrix of an intrinsic triangulation, whose cover has so many copies of every
/// triangle: W_ij = -weight, W_ii = -sum_j W_ij; zero weights are stored, too.
SparseMatrix stiffnessOf(const IntrinsicTriangulation& triangulation, int copies,
                         Index vertexCount) {
    // Column j has room for an entry of every side that starts in j, and the diagonal.
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
            // By value, too: W_ij and W_ji sum in the same order; W is symmetric to the bit.
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
    // Columns move up, if any has room left.
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

IntrinsicDelaunay::IntrinsicDelaunay(const Vertices& V, const Faces& F) : vertexCount_(V.rows()) {
    SidesByEdge edges(F, V.rows());
    const int front = static_cast<int>(3 * F.rows());
    const auto runsUp = [&](const EdgeSide& s) { return F(s.side / 3, s.side % 3) == s.low; };
    std::atomic<bool> closedAndOriented = true;
    edges.forEachEdge([&](const EdgeSide* first, const EdgeSide* last) {
        if (last - first != 2 || runsUp(first[0]) == runsUp(first[1])) closedAndOriented = false;
    });
    copies_ = closedAndOriented ? 1 : 2;

    tail_.resize(static_cast<std::size_t>(copies_) * front);
    twin_.resize(tail_.size());
    for (int s = 0; s < front; ++s) tail_[s] = F(s / 3, s % 3);

    // The back of a triangle (a, b, c) is (a, c, b): its side 2 - s lies on side s of the front.
    const auto back = [front](int side) { return front + 3 * (side / 3) + 2 - side % 3; };
    if (copies_ == 2)
        for (int s = 0; s < front; ++s) tail_[back(s)] = F(s / 3, (s + 1 - 3 * (s / 3)) % 3);
    edges.forEachEdge([&](EdgeSide* first, EdgeSide* last) {
        if (last - first > 2) sortByAngle(V, F, first, last);
        // The copy that runs up the edge faces larger angles: it is glued to the copy of the next
        // triangle that runs down. The triangle of a boundary edge is glued to its own back.
        for (const EdgeSide* here = first; here != last; ++here) {
            const EdgeSide* there = here + 1 != last ? here + 1 : first;
            const int up = runsUp(*here) ? here->side : back(here->side);
            if (copies_ == 1 && up >= front) continue;
            const int down = runsUp(*there) ? back(there->side) : there->side;
            twin_[up] = down;
            twin_[down] = up;
        }
    });
}

IntrinsicTriangulation IntrinsicDelaunay::triangulation(const Vertices& V) const {
    std::vector<double> length(tail_.size());
    parallelRows(static_cast<Index>(tail_.size()), [&](Index begin, Index end) {
        for (Index s = begin; s < end; ++s)
            length[s] = (V.row(tail_[nextSide(static_cast<int>(s))]) - V.row(tail_[s])).norm();
    });

    // The smallest mollification that makes every triangle inequality hold by the margin.
    const double meanLength =
        std::accumulate(length.begin(), length.end(), 0.0) / static_cast<double>(length.size());
    const double epsilon =
        parallelMax(static_cast<Index>(length.size()), [&](Index begin, Index end) {
            double most = 0.0;
            for (int s = static_cast<int>(begin); s < end; ++s)
                most = std::max(most, length[s] - length[nextSide(s)] - length[previousSide(s)] +
                                          kMollification * meanLength);
            return most;
        });
    if (epsilon > 0.0)
        for (double& l : length) l += epsilon;

    IntrinsicTriangulation triangulation(tail_, twin_, std::move(length));
    triangulation.makeDelaunay();
    return triangulation;
}

SparseMatrix IntrinsicDelaunay::stiffness(const Vertices& V) const {
    return stiffnessOf(triangulation(V), copies_, vertexCount_);
}

}  // namespace spectral
