#include "core/mesh/sides.h"

#include <algorithm>
#include <tuple>

#include "core/support/threads.h"
#include "core/support/types.h"

namespace spectral {

std::vector<Side> sidesByEdge(const Faces& F) {
    // A bucket sort by the lower vertex, which few sides share.
    const auto vertices = static_cast<std::size_t>(F.size() > 0 ? F.maxCoeff() + 1 : 0);
    const auto ends = [&](Index t, int c) {
        return std::minmax({F(t, (c + 1) % 3), F(t, (c + 2) % 3)});
    };
    std::vector<Index> begin(vertices + 1, 0);
    forEachInOrder(F.rows(), [&](Index t) {
        for (int c = 0; c < 3; ++c) ++begin[ends(t, c).first + 1];
    });
    for (std::size_t i = 0; i < vertices; ++i) begin[i + 1] += begin[i];

    std::vector<Side> sides(static_cast<std::size_t>(3 * F.rows()));
    std::vector<Index> next(begin);
    forEachInOrder(F.rows(), [&](Index t) {
        for (int c = 0; c < 3; ++c) {
            const auto [low, high] = ends(t, c);
            sides[next[low]++] = {low, high, static_cast<int>(t), c};
        }
    });
    parallelRows(static_cast<Index>(vertices), [&](Index first, Index last) {
        for (Index i = first; i < last; ++i)
            std::sort(sides.begin() + begin[i], sides.begin() + begin[i + 1],
                      [](const Side& a, const Side& b) {
                          return std::tie(a.high, a.face) < std::tie(b.high, b.face);
                      });
    });
    return sides;
}

}  // namespace spectral
