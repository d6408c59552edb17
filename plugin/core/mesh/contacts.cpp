#include "core/mesh/contacts.h"

#include <algorithm>
#include <array>
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

}  // namespace spectral
