#include "core/mesh/sides.h"

#include <algorithm>
#include <tuple>

namespace spectral {

std::vector<Side> sidesByEdge(const Faces& F) {
    std::vector<Side> sides;
    sides.reserve(static_cast<std::size_t>(3 * F.rows()));
    for (Index t = 0; t < F.rows(); ++t)
        for (int c = 0; c < 3; ++c) {
            const auto [low, high] = std::minmax({F(t, (c + 1) % 3), F(t, (c + 2) % 3)});
            sides.push_back({low, high, static_cast<int>(t), c});
        }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
        return std::tie(a.low, a.high, a.face) < std::tie(b.low, b.high, b.face);
    });
    return sides;
}

}  // namespace spectral
