#include "pair_store.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "errors.h"

namespace spectral {

Eigen::VectorXd PairStore::lambdas() const {
    Eigen::VectorXd all(size());
    for (Index i = 0; i < size(); ++i) all[i] = lambda(i);
    return all;
}

Index PairStore::claim(const Eigen::VectorXd& lambda, unsigned run) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const Index first = size();
    if (first + lambda.size() > Phi_.cols())
        throw SolverFailure(
            "the harmonics could not be told apart: more of them were found than the inertia of W "
            "- sigma D counts");
    for (Index i = 0; i < lambda.size(); ++i) pairs_.push_back({lambda[i], run, i});
    return first;
}

void PairStore::sort() {
    std::vector<Index> order(pairs_.size());  // order[i]: the column that is to become column i
    std::iota(order.begin(), order.end(), Index{0});
    const auto key = [&](Index i) {
        const Pair& pair = pairs_[static_cast<std::size_t>(i)];
        return std::make_tuple(pair.lambda, pair.run, pair.place);
    };
    std::sort(order.begin(), order.end(), [&](Index a, Index b) { return key(a) < key(b); });
    // Round each cycle of the permutation, with one column out of the way.
    for (std::size_t start = 0; start < order.size(); ++start) {
        const Eigen::VectorXd phi = Phi_.col(static_cast<Index>(start));
        const Pair pair = pairs_[start];
        std::size_t i = start;
        while (static_cast<std::size_t>(order[i]) != start) {
            const auto next = static_cast<std::size_t>(order[i]);
            Phi_.col(static_cast<Index>(i)) = Phi_.col(static_cast<Index>(next));
            pairs_[i] = pairs_[next];
            order[i] = static_cast<Index>(i);
            i = next;
        }
        Phi_.col(static_cast<Index>(i)) = phi;
        pairs_[i] = pair;
        order[i] = static_cast<Index>(i);
    }
}

}  // namespace spectral
