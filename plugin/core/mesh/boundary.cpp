#include "core/mesh/boundary.h"

#include <algorithm>
#include <utility>

#include "core/mesh/mesh.h"

namespace spectral {

std::vector<bool> boundaryVertices(const Faces& F, Index vertexCount) {
    std::vector<std::pair<int, int>> edges;
    edges.reserve(static_cast<std::size_t>(3 * F.rows()));
    for (Index t = 0; t < F.rows(); ++t)
        for (int c = 0; c < 3; ++c) edges.push_back(std::minmax({F(t, c), F(t, (c + 1) % 3)}));
    std::sort(edges.begin(), edges.end());

    std::vector<bool> onBoundary(static_cast<std::size_t>(vertexCount), false);
    for (std::size_t first = 0, next = 0; first < edges.size(); first = next) {
        while (next < edges.size() && edges[next] == edges[first]) ++next;
        if (next - first == 1)
            onBoundary[edges[first].first] = onBoundary[edges[first].second] = true;
    }
    return onBoundary;
}

}  // namespace spectral
