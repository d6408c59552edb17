#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

#include "core/support/types.h"

namespace spectral {

/// Disjoint sets of the numbers 0 to n - 1, each represented by its smallest member; path halving.
class UnionFind {
  public:
    explicit UnionFind(Index n) : parent_(static_cast<std::size_t>(n)), count_(n) {
        std::iota(parent_.begin(), parent_.end(), 0);
    }

    /// The smallest member of the set that contains i.
    int root(int i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }

    /// Merges the sets of i and j.
    void unite(int i, int j) {
        const auto [first, second] = std::minmax({root(i), root(j)});
        if (first != second) --count_;
        parent_[second] = first;
    }

    /// The root of every number.
    std::vector<int> roots() {
        for (int i = 0; i < static_cast<int>(parent_.size()); ++i) parent_[i] = root(i);
        return parent_;
    }

    Index count() const { return count_; }  ///< Number of sets.

  private:
    std::vector<int> parent_;
    Index count_;
};

}  // namespace spectral
