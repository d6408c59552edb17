#include "core/laplacian/intrinsic_delaunay.h"

#include <Eigen/Geometry>
#include <algorithm>
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
std::vector<EdgeSide> sidesByEdge(const Faces& F, Index vertexCount) {
    // A bucket sort by the lower vertex, which few sides share.
    std::vector<int> begin(static_cast<std::size_t>(vertexCount) + 1, 0);
    const auto forEachSide = [&F](const auto& visit) {
        for (int t = 0; t < F.rows(); ++t)
            for (int c = 0; c < 3; ++c) {
                const int i = F(t, c), j = F(t, c == 2 ? 0 : c + 1);
                visit(EdgeSide{std::min(i, j), std::max(i, j), 3 * t + c});
            }
    };
    forEachSide([&](const EdgeSide& s) { ++begin[s.low + 1]; });
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    std::vector<EdgeSide> sides(static_cast<std::size_t>(3 * F.rows()));
    std::vector<int> next(begin.begin(), begin.end() - 1);
    forEachSide([&](const EdgeSide& s) { sides[next[s.low]++] = s; });
    parallelRows(vertexCount, [&](Index first, Index last) {
        for (Index i = first; i < last; ++i)
            std::sort(sides.begin() + begin[i], sides.begin() + begin[i + 1]);
    });
    return sides;
}

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

/// W_ij = -weight, W_ii = -sum_j W_ij; zero weights are stored, too.
/// @param forEachEdge  calls its argument with (i, j, weight) for every edge, the same each time;
///                     several edges may join i and j.
template <class ForEachEdge>
SparseMatrix stiffnessOf(const ForEachEdge& forEachEdge, Index vertexCount) {
    struct Entry {
        int row;
        double value;
    };
    std::vector<int> begin(static_cast<std::size_t>(vertexCount) + 1, 1);  // 1 for the diagonal
    begin[0] = 0;
    forEachEdge([&](int i, int j, double) {
        ++begin[i + 1];
        ++begin[j + 1];
    });
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    std::vector<Entry> entries(static_cast<std::size_t>(begin.back()));
    std::vector<int> next(begin.begin(), begin.end() - 1);
    for (int i = 0; i < vertexCount; ++i) entries[next[i]++] = {i, 0.0};
    forEachEdge([&](int i, int j, double weight) {
        entries[next[i]++] = {j, -weight};
        entries[next[j]++] = {i, -weight};
        entries[begin[i]].value += weight;
        entries[begin[j]].value += weight;
    });
    parallelRows(vertexCount, [&](Index first, Index last) {
        // By value, too: W_ij and W_ji then sum in the same order, and W is symmetric to the bit.
        for (Index j = first; j < last; ++j)
            std::sort(entries.begin() + begin[j], entries.begin() + begin[j + 1],
                      [](const Entry& a, const Entry& b) {
                          return std::pair(a.row, a.value) < std::pair(b.row, b.value);
                      });
    });

    SparseMatrix W(vertexCount, vertexCount);
    W.reserve(begin.back());
    for (Index j = 0; j < vertexCount; ++j) {
        const auto first = entries.begin() + begin[j], last = entries.begin() + begin[j + 1];
        W.startVec(j);
        for (auto entry = first; entry != last;) {
            const int row = entry->row;
            double& value = W.insertBack(row, j);
            for (value = 0.0; entry != last && entry->row == row; ++entry) value += entry->value;
        }
    }
    W.finalize();
    return W;
}

}  // namespace

IntrinsicDelaunay::IntrinsicDelaunay(const Vertices& V, const Faces& F) : vertexCount_(V.rows()) {
    std::vector<EdgeSide> sides = sidesByEdge(F, V.rows());
    const int front = static_cast<int>(3 * F.rows());
    const auto runsUp = [&](const EdgeSide& s) { return F(s.side / 3, s.side % 3) == s.low; };
    const auto endOfEdge = [&](std::size_t begin) {
        std::size_t end = begin;
        while (end < sides.size() && sides[end].low == sides[begin].low &&
               sides[end].high == sides[begin].high)
            ++end;
        return end;
    };

    bool closedAndOriented = true;
    for (std::size_t begin = 0; begin < sides.size();) {
        const std::size_t end = endOfEdge(begin);
        oneSide_.push_back(sides[begin].side);
        closedAndOriented = closedAndOriented && end - begin == 2 &&
                            runsUp(sides[begin]) != runsUp(sides[begin + 1]);
        begin = end;
    }
    copies_ = closedAndOriented ? 1 : 2;

    tail_.resize(static_cast<std::size_t>(copies_) * front);
    twin_.resize(tail_.size());
    for (int s = 0; s < front; ++s) tail_[s] = F(s / 3, s % 3);

    // The back of a triangle (a, b, c) is (a, c, b): its side 2 - s lies on side s of the front.
    const auto back = [front](int side) { return front + 3 * (side / 3) + 2 - side % 3; };
    if (copies_ == 2)
        for (int s = 0; s < front; ++s) tail_[back(s)] = F(s / 3, (s + 1 - 3 * (s / 3)) % 3);
    for (std::size_t begin = 0; begin < sides.size();) {
        const std::size_t end = endOfEdge(begin);
        if (end - begin > 2) sortByAngle(V, F, sides.data() + begin, sides.data() + end);
        // The copy that runs up the edge faces larger angles: it is glued to the copy of the next
        // triangle that runs down. The triangle of a boundary edge is glued to its own back.
        for (std::size_t e = begin; e < end; ++e) {
            const EdgeSide& here = sides[e];
            const EdgeSide& there = sides[e + 1 < end ? e + 1 : begin];
            const int up = runsUp(here) ? here.side : back(here.side);
            if (copies_ == 1 && up >= front) continue;
            const int down = runsUp(there) ? back(there.side) : there.side;
            twin_[up] = down;
            twin_[down] = up;
        }
        begin = end;
    }
}

IntrinsicTriangulation IntrinsicDelaunay::triangulation(const Vertices& V) const {
    std::vector<double> length(tail_.size());
    parallelRows(static_cast<Index>(tail_.size()), [&](Index begin, Index end) {
        for (Index s = begin; s < end; ++s)
            length[s] = (V.row(tail_[nextSide(static_cast<int>(s))]) - V.row(tail_[s])).norm();
    });

    // The smallest mollification that makes every triangle inequality hold by the margin.
    double meanLength = 0.0;
    for (const int s : oneSide_) meanLength += length[s];
    meanLength /= static_cast<double>(oneSide_.size());
    double epsilon = 0.0;
    for (int s = 0; s < static_cast<int>(tail_.size()); ++s)
        epsilon = std::max(epsilon, length[s] - length[nextSide(s)] - length[previousSide(s)] +
                                        kMollification * meanLength);
    for (double& l : length) l += epsilon;

    IntrinsicTriangulation triangulation(tail_, twin_, std::move(length));
    triangulation.makeDelaunay();
    return triangulation;
}

SparseMatrix IntrinsicDelaunay::stiffness(const Vertices& V) const {
    const IntrinsicTriangulation delaunay = triangulation(V);
    const auto forEachEdge = [&](const auto& visit) {
        for (int s = 0; s < delaunay.sideCount(); ++s) {
            const int t = delaunay.twin(s), i = delaunay.tail(s), j = delaunay.tail(t);
            if (s > t || i == j) continue;  // every edge once, loops not at all
            visit(i, j, 0.5 / copies_ * std::max(0.0, delaunay.edgeCotangents(s)));
        }
    };
    return stiffnessOf(forEachEdge, vertexCount_);
}

}  // namespace spectral
