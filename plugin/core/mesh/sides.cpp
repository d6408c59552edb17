#include "core/mesh/sides.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace spectral {

SidesByEdge::SidesByEdge(const Faces& F)
    : sides_(static_cast<std::size_t>(F.size())),
      begin_(static_cast<std::size_t>(F.size() > 0 ? F.maxCoeff() + 2 : 1), 0) {
    // Bucket sort by the lower vertex: only few sides share one.
    const auto forEachSide = [&F](const auto& visit) {
        forEachInOrder(F.rows(), [&](Index t) {
            for (int c = 0; c < 3; ++c) {
                const int i = F(t, c), j = F(t, c == 2 ? 0 : c + 1);
                visit(Side{std::min(i, j), std::max(i, j), static_cast<int>(3 * t) + c});
            }
        });
    };
    forEachSide([&](const Side& s) { ++begin_[s.low + 1]; });
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    std::vector<int> next(begin_.begin(), begin_.end() - 1);
    forEachSide([&](const Side& s) { sides_[next[s.low]++] = s; });
    parallelRows(static_cast<Index>(next.size()), [&](Index first, Index last) {
        for (Index i = first; i < last; ++i)
            std::sort(sides_.begin() + begin_[i], sides_.begin() + begin_[i + 1],
                      [](const Side& a, const Side& b) {
                          return std::tie(a.high, a.number) < std::tie(b.high, b.number);
                      });
    });
}

}  // namespace spectral
