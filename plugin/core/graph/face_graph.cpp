#include "core/graph/face_graph.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "core/mesh/sides.h"
#include "core/support/threads.h"

namespace spectral {

namespace {

/// Reverses faces to orient neighbours consistently, starting at the first face of each component.
/// @param isOpposite  m x 3: whether the neighbour has the opposite orientation.
void orient(const Eigen::Matrix<bool, Eigen::Dynamic, 3>& isOpposite, FaceGraph& graph) {
    std::vector<char> isReached(static_cast<std::size_t>(graph.faceCount()), 0);
    std::vector<std::pair<int, bool>> stack;
    for (int start = 0; start < graph.faceCount(); ++start) {
        if (!isReached[start]) stack.emplace_back(start, false);
        isReached[start] = 1;
        while (!stack.empty()) {
            const auto [face, isReversed] = stack.back();
            stack.pop_back();
            for (int c = 0; c < 3; ++c) {
                const int next = graph.neighbours(face, c);
                if (next < 0 || isReached[next]) continue;
                isReached[next] = 1;
                stack.emplace_back(next, isReversed != isOpposite(face, c));
            }
            if (!isReversed) continue;
            std::swap(graph.F(face, 1), graph.F(face, 2));
            std::swap(graph.neighbours(face, 1), graph.neighbours(face, 2));
        }
    }
}

/// Turns the counts at first[i + 1] into offsets.
void accumulate(VertexGraph& graph) {
    for (std::size_t i = 1; i < graph.first.size(); ++i) graph.first[i] += graph.first[i - 1];
    graph.at.resize(static_cast<std::size_t>(graph.first.back()));
}

VertexGraph facesOfVertices(const Faces& F, Index vertexCount) {
    VertexGraph graph;
    graph.first.assign(static_cast<std::size_t>(vertexCount) + 1, 0);
    for (Index t = 0; t < F.rows(); ++t)
        for (int c = 0; c < 3; ++c) ++graph.first[F(t, c) + 1];
    accumulate(graph);
    std::vector<Index> next(graph.first);
    for (Index t = 0; t < F.rows(); ++t)
        for (int c = 0; c < 3; ++c) graph.at[next[F(t, c)]++] = static_cast<int>(t);
    return graph;
}

VertexGraph neighboursOfVertices(const SidesByEdge& sides, Index vertexCount) {
    VertexGraph graph;
    graph.first.assign(static_cast<std::size_t>(vertexCount) + 1, 0);
    sides.forEachEdge([&](auto first, auto) {
        ++graph.first[first->low + 1];
        ++graph.first[first->high + 1];
    });
    accumulate(graph);
    std::vector<Index> next(graph.first);
    // Edges come by ascending lower vertex, so each vertex gets its neighbours in ascending order.
    sides.forEachEdge([&](auto first, auto) {
        graph.at[next[first->low]++] = first->high;
        graph.at[next[first->high]++] = first->low;
    });
    return graph;
}

/// A vector scaled to length 1; zero stays zero. Avoids the slower stableNormalized unless squares
/// underflow or overflow.
Eigen::RowVector3d unit(const Eigen::RowVector3d& v) {
    constexpr double kSafe = 1e-280;
    const double squared = v.squaredNorm();
    if (squared > kSafe && squared < 1.0 / kSafe) return v / std::sqrt(squared);
    return v.stableNormalized();
}

}  // namespace

Faces distinctFaces(const Faces& F, Index vertexCount) {
    Faces sorted = F;
    for (auto face : sorted.rowwise()) std::sort(face.begin(), face.end());
    std::vector<Index> first(static_cast<std::size_t>(vertexCount) + 1, 0);
    for (Index t = 0; t < F.rows(); ++t) ++first[sorted(t, 0) + 1];
    for (std::size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
    std::vector<Index> next(first), at(static_cast<std::size_t>(F.rows()));
    for (Index t = 0; t < F.rows(); ++t) at[next[sorted(t, 0)]++] = t;
    std::vector<bool> isRepeated(at.size(), false);
    Index count = F.rows();
    for (Index i = 0; i < vertexCount; ++i) {
        const auto begin = at.begin() + first[i], end = at.begin() + first[i + 1];
        const auto key = [&](Index t) { return std::tuple(sorted(t, 1), sorted(t, 2), t); };
        std::sort(begin, end, [&](Index s, Index t) { return key(s) < key(t); });
        for (auto k = begin; k != end; ++k) {
            if (k == begin || sorted.row(*k) != sorted.row(*(k - 1))) continue;
            isRepeated[*k] = true;
            --count;
        }
    }
    Faces distinct(count, 3);
    for (Index t = F.rows() - 1; t >= 0; --t)
        if (!isRepeated[t]) distinct.row(--count) = F.row(t);
    return distinct;
}

FaceGraph faceGraph(const Faces& F, Index vertexCount) {
    FaceGraph graph;
    graph.F = F;
    graph.onRim.assign(static_cast<std::size_t>(vertexCount), false);
    graph.neighbours = Faces::Constant(F.rows(), 3, -1);
    Eigen::Matrix<bool, Eigen::Dynamic, 3> isOpposite(F.rows(), 3);
    // Whether the face traverses the side from its higher to its lower vertex.
    const auto isReversed = [&](const Side& side) {
        return F(side.face(), side.corner()) == side.high;
    };
    const SidesByEdge sides(F);
    sides.forEachEdge([&](auto first, auto end) {
        if (end - first != 2) {
            graph.onRim[first->low] = graph.onRim[first->high] = true;
            return;
        }
        const Side &a = *first, &b = *(first + 1);
        graph.neighbours(a.face(), a.opposite()) = b.face();
        graph.neighbours(b.face(), b.opposite()) = a.face();
        isOpposite(a.face(), a.opposite()) = isOpposite(b.face(), b.opposite()) =
            isReversed(a) == isReversed(b);
    });
    orient(isOpposite, graph);
    graph.faces = facesOfVertices(F, vertexCount);
    graph.vertices = neighboursOfVertices(sides, vertexCount);
    return graph;
}

VertexGraph weightedByLength(VertexGraph graph, const Points& X, double power) {
    constexpr double kShortest = 1e-9;  // of the lengths at a vertex, over their mean
    graph.weight.resize(graph.at.size());
    parallelRows(graph.size(), [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) {
            const Index first = graph.first[i], last = graph.first[i + 1];
            double lengths = 0.0, sum = 0.0;
            for (Index k = first; k < last; ++k)
                lengths += graph.weight[k] = (X.row(graph.at[k]) - X.row(i)).norm();
            const double mean = lengths / static_cast<double>(std::max<Index>(last - first, 1));
            for (Index k = first; k < last; ++k) {
                const double relative = mean > 0.0 ? graph.weight[k] / mean : 1.0;
                sum += graph.weight[k] = std::pow(std::max(relative, kShortest), -power);
            }
            for (Index k = first; k < last; ++k) graph.weight[k] /= sum;
        }
    });
    return graph;
}

Points areaNormals(const Points& X, const Faces& F) {
    Points N(F.rows(), 3);
    parallelRows(F.rows(), [&](Index begin, Index end) {
        for (Index t = begin; t < end; ++t) {
            const Eigen::RowVector3d a = X.row(F(t, 0)), b = X.row(F(t, 1)), c = X.row(F(t, 2));
            N.row(t) = (b - a).cross(c - a);
        }
    });
    return N;
}

Points blurredNormals(const FaceGraph& graph, Points N, int times) {
    Points sum(N.rows(), 3);
    for (int k = 0; k < times; ++k) {
        parallelRows(N.rows(), [&](Index begin, Index end) {
            for (Index t = begin; t < end; ++t) {
                Eigen::RowVector3d here = N.row(t);
                for (int c = 0; c < 3; ++c)
                    if (graph.neighbours(t, c) >= 0) here += N.row(graph.neighbours(t, c));
                sum.row(t) = here;
            }
        });
        N.swap(sum);
    }
    return N;
}

Points vertexNormals(const FaceGraph& graph, const Points& N) {
    Points normals(graph.vertexCount(), 3);
    parallelRows(graph.vertexCount(), [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) {
            Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
            for (Index k = graph.faces.first[i]; k < graph.faces.first[i + 1]; ++k)
                sum += N.row(graph.faces.at[k]);
            normals.row(i) = unit(sum);
        }
    });
    return normals;
}

std::vector<double> triangleQuality(const Faces& F, const Points& X) {
    std::vector<double> quality(static_cast<std::size_t>(F.rows()));
    const Points N = areaNormals(X, F);
    parallelRows(F.rows(), [&](Index begin, Index end) {
        for (Index f = begin; f < end; ++f) {
            double squares = 0.0;
            for (int c = 0; c < 3; ++c)
                squares += (X.row(F(f, c)) - X.row(F(f, (c + 1) % 3))).squaredNorm();
            quality[f] = squares > 0.0 ? 2.0 * std::sqrt(3.0) * N.row(f).norm() / squares : 0.0;
        }
    });
    return quality;
}

void normalizeRows(Points& N) {
    parallelRows(N.rows(), [&](Index begin, Index end) {
        for (Index t = begin; t < end; ++t) N.row(t) = unit(N.row(t));
    });
}

}  // namespace spectral
