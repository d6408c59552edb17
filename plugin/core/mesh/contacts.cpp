#include "core/mesh/contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

namespace spectral {

void moveContactsAlike(const Surface& surface, const Components& components,
                       Vertices& displacement) {
    if (components.count < 2) return;
    const Vertices& X = surface.X;
    const auto point = [&](int i) { return std::array{X(i, 0), X(i, 1), X(i, 2)}; };
    std::vector<int> sorted(static_cast<std::size_t>(X.rows()));
    std::iota(sorted.begin(), sorted.end(), 0);
    std::stable_sort(sorted.begin(), sorted.end(),
                     [&](int i, int j) { return point(i) < point(j); });
    for (auto first = sorted.begin(), end = first; first != sorted.end(); first = end) {
        while (end != sorted.end() && point(*end) == point(*first)) ++end;
        const auto isOther = [&](int i) { return components.label[i] != components.label[*first]; };
        const auto moves = [&](int i) { return !displacement.row(i).isZero(0.0); };
        if (std::none_of(first, end, isOther) || !std::all_of(first, end, moves)) continue;
        // By differences: the mean of equal displacements is then exactly that displacement.
        Eigen::RowVector3d mean = displacement.row(*first);
        for (auto i = first; i != end; ++i)
            mean += (displacement.row(*i) - displacement.row(*first)) /
                    static_cast<double>(end - first);
        for (auto i = first; i != end; ++i) displacement.row(*i) = mean;
    }
}

Parting partingOf(const Vertices& V, const Faces& F, const Vertices& moved, double near) {
    constexpr double kCell = 4.0;       // in `near`
    constexpr int kMostVertices = 500;  // of a cell: all pairs are compared
    const Surface surface = joinedSurface(V, F);
    const auto [label, count] = connectedComponents(surface.F, surface.X.rows());
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
