#include "core/mesh/components.h"

#include <numeric>
#include <utility>
#include <vector>

#include "core/mesh/mesh.h"

namespace spectral {

namespace {

/// Union-find with path halving.
class DisjointSets {
  public:
    explicit DisjointSets(Index size) : parent_(static_cast<std::size_t>(size)) {
        std::iota(parent_.begin(), parent_.end(), 0);
    }
    int find(int i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    // The smaller index becomes the root, so that labels ascend with the first vertex.
    void unite(int i, int j) {
        i = find(i);
        j = find(j);
        if (i > j) std::swap(i, j);
        parent_[j] = i;
    }

  private:
    std::vector<int> parent_;
};

}  // namespace

Components connectedComponents(const Faces& F, Index vertexCount) {
    DisjointSets sets(vertexCount);
    for (Index t = 0; t < F.rows(); ++t) {
        sets.unite(F(t, 0), F(t, 1));
        sets.unite(F(t, 0), F(t, 2));
    }
    Components components{Eigen::VectorXi(vertexCount), 0};
    for (int i = 0; i < vertexCount; ++i) {
        const int root = sets.find(i);
        components.label[i] = root == i ? components.count++ : components.label[root];
    }
    return components;
}

}  // namespace spectral
