#include "core/mesh/contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

#include "core/mesh/union_find.h"

namespace spectral {

namespace {

/// A side of a triangle between points that other vertices are at, too.
struct SharedSide {
    int low, high;  // the first vertices at its points
    int from, to;   // its vertices there
    int label;      // its component
    bool isReversed;
    Eigen::RowVector3d across;  // unit vector from the side to the opposite corner, or 0
};

/// For each vertex the first one at its point; -1 where all are of one component.
std::vector<int> sharedPoints(const Vertices& X, const Components& components) {
    const auto point = [&](int i) { return std::array{X(i, 0), X(i, 1), X(i, 2)}; };
    std::vector<int> sorted(static_cast<std::size_t>(X.rows())), place(sorted.size(), -1);
    std::iota(sorted.begin(), sorted.end(), 0);
    std::stable_sort(sorted.begin(), sorted.end(),
                     [&](int i, int j) { return point(i) < point(j); });
    for (auto first = sorted.begin(), end = first; first != sorted.end(); first = end) {
        while (end != sorted.end() && point(*end) == point(*first)) ++end;
        const auto isOther = [&](int i) { return components.label[i] != components.label[*first]; };
        if (std::any_of(first, end, isOther))
            for (auto i = first; i != end; ++i) place[*i] = *first;
    }
    return place;
}

std::vector<SharedSide> sharedSides(const Surface& surface, const Components& components) {
    const Vertices& X = surface.X;
    const std::vector<int> place = sharedPoints(X, components);
    std::vector<SharedSide> sides;
    for (Index t = 0; t < surface.F.rows(); ++t)
        for (int c = 0; c < 3; ++c) {
            int from = surface.F(t, c), to = surface.F(t, (c + 1) % 3);
            if (place[from] < 0 || place[to] < 0 || place[from] == place[to]) continue;
            const bool isReversed = place[from] > place[to];
            if (isReversed) std::swap(from, to);
            const Eigen::RowVector3d along = (X.row(to) - X.row(from)).normalized();
            Eigen::RowVector3d across = X.row(surface.F(t, (c + 2) % 3)) - X.row(from);
            across -= across.dot(along) * along;
            sides.push_back({place[from], place[to], from, to, components.label[from], isReversed,
                             across.normalized()});
        }
    std::sort(sides.begin(), sides.end(), [](const SharedSide& a, const SharedSide& b) {
        return std::tie(a.low, a.high, a.label, a.from, a.to) <
               std::tie(b.low, b.high, b.label, b.from, b.to);
    });
    return sides;
}

/// Whether two components touch at an edge. Of bodies that do, the faces next to each other run
/// opposite ways along it; those of surfaces that lie over one another, such as two levels of
/// detail, run the same way. A sheet may end at an edge of another surface.
template <class Sides>
bool touch(Sides first, Sides endOfFirst, Sides other, Sides endOfOther) {
    if ((endOfFirst - first == 1) != (endOfOther - other == 1)) return true;
    double nearest = -2.0;
    bool areOpposite = false;
    for (auto a = first; a != endOfFirst; ++a)
        for (auto b = other; b != endOfOther; ++b)
            if (const double cosine = a->across.dot(b->across); cosine > nearest) {
                nearest = cosine;
                areOpposite = a->isReversed != b->isReversed;
            }
    return areOpposite;
}

}  // namespace

void moveContactsAlike(const Surface& surface, const Components& components,
                       Vertices& displacement) {
    if (components.count < 2) return;
    const std::vector<SharedSide> sides = sharedSides(surface, components);
    UnionFind alike(surface.X.rows());
    const auto endOfEdge = [&](auto first) {
        return std::find_if(first, sides.end(), [&](const SharedSide& s) {
            return s.low != first->low || s.high != first->high;
        });
    };
    const auto endOfLabel = [&](auto first, auto end) {
        return std::find_if(first, end,
                            [&](const SharedSide& s) { return s.label != first->label; });
    };
    for (auto edge = sides.begin(); edge != sides.end(); edge = endOfEdge(edge)) {
        const auto end = endOfEdge(edge);
        for (auto a = edge; a != end; a = endOfLabel(a, end))
            for (auto b = endOfLabel(a, end); b != end; b = endOfLabel(b, end)) {
                if (!touch(a, endOfLabel(a, end), b, endOfLabel(b, end))) continue;
                alike.unite(a->from, b->from);
                alike.unite(a->to, b->to);
            }
    }
    std::vector<std::pair<int, int>> rows;  // the set of each vertex, and the vertex
    for (const SharedSide& side : sides)
        for (const int i : {side.from, side.to}) rows.emplace_back(alike.root(i), i);
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    for (auto first = rows.begin(), end = first; first != rows.end(); first = end) {
        end =
            std::find_if(first, rows.end(), [&](const auto& r) { return r.first != first->first; });
        const auto moves = [&](const auto& r) { return !displacement.row(r.second).isZero(0.0); };
        if (!std::all_of(first, end, moves)) continue;
        // By differences: the mean of equal displacements is then exactly that displacement.
        const Eigen::RowVector3d one = displacement.row(first->second);
        Eigen::RowVector3d mean = one;
        for (auto r = first; r != end; ++r)
            mean += (displacement.row(r->second) - one) / static_cast<double>(end - first);
        for (auto r = first; r != end; ++r) displacement.row(r->second) = mean;
    }
}

Parting partingOf(const Vertices& V, const Faces& F, const Vertices& moved, double near) {
    constexpr double kCell = 4.0;       // in `near`
    constexpr int kMostVertices = 500;  // of a cell: all pairs are compared
    const Surface surface = joinedSurface(V, F);
    const Components components = connectedComponents(surface.F, surface.X.rows());
    const auto& [label, count] = components;
    Parting parting;
    parting.all = count;
    if (count < 2) return parting;
    const auto rows = static_cast<std::size_t>(surface.X.rows());
    std::vector<int> size(static_cast<std::size_t>(count), 0), sorted(rows);
    std::vector<std::array<double, 3>> cell(rows);
    for (std::size_t i = 0; i < rows; ++i) {
        ++size[label[i]];
        sorted[i] = static_cast<int>(i);
        for (int c = 0; c < 3; ++c) cell[i][c] = std::floor(surface.X(i, c) / (kCell * near));
    }
    std::sort(sorted.begin(), sorted.end(), [&](int i, int j) { return cell[i] < cell[j]; });
    const auto distance = [&](const Vertices& at, int i, int j) {
        return (at.row(surface.vertex[i]) - at.row(surface.vertex[j])).norm();
    };
    std::vector<bool> parts(static_cast<std::size_t>(count), false);
    for (auto first = sorted.begin(), end = first; first != sorted.end(); first = end) {
        bool isMixed = false;
        for (; end != sorted.end() && cell[*end] == cell[*first]; ++end)
            isMixed = isMixed || label[*end] != label[*first];
        if (!isMixed || end - first > kMostVertices) continue;
        for (auto i = first; i != end; ++i)
            for (auto j = first; j != i; ++j) {
                if (label[*i] == label[*j]) continue;
                const double before = distance(V, *i, *j);
                if (before > near) continue;
                const double growth = distance(moved, *i, *j) - before;
                if (growth <= near) continue;
                const int a = label[*i], b = label[*j];
                parts[size[a] < size[b] ? a : b] = true;
                parting.distance = std::max(parting.distance, growth);
            }
    }
    parting.components = static_cast<int>(std::count(parts.begin(), parts.end(), true));
    return parting;
}

}  // namespace spectral
