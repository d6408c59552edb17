#include "core/ldlt/ldlt_elimination.h"

#include <algorithm>
#include <cstddef>

#include "core/kernels/kernels.h"
#include "core/support/threads.h"

namespace spectral {

namespace {

/// The front of a supernode, without its memory.
FrontalMatrix shapeOf(const SymbolicLdlt::Front& supernode) {
    const auto padded = [](Index rows) { return (rows + kLane - 1) / kLane * kLane; };
    FrontalMatrix front;
    front.width = supernode.width;
    front.below = supernode.below;
    front.offset = padded(front.width) - front.width;
    front.stride = front.offset + front.width + padded(front.below);
    return front;
}

/// What a front has left in the rows below its columns, until it goes to the parent's.
struct Waiting {
    const SymbolicLdlt::Front* supernode = nullptr;
    Index at = 0;                       // on the stack of its elimination,
    const double* elsewhere = nullptr;  // or here
};

class Elimination;

/// Fronts that follow one another, and the subtree behind them that another elimination has done.
struct Stretch {
    int begin = 0, end = 0;
    const Elimination* subtree = nullptr;
    const SymbolicLdlt::Front* root = nullptr;  // of the subtree
};

/// The elimination of some stretches of fronts, from the leaves up. What a front leaves for its
/// parent waits on a stack.
class Elimination {
  public:
    Elimination(const SymbolicLdlt& symbolic, const double* W, const Eigen::VectorXd& shifts,
                LdltNumbers& numbers)
        : symbolic_(symbolic), W_(W), shifts_(shifts), numbers_(numbers) {}

    /// False when a pivot is 0.
    bool run(const std::vector<Stretch>& stretches) {
        allocate(stretches);
        for (const Stretch& stretch : stretches) {
            for (int f = stretch.begin; f < stretch.end; ++f)
                if (!eliminateFront(symbolic_.fronts[f])) return false;
            take(stretch);
        }
        return true;
    }

  private:
    /// Goes through the fronts as they will come, for the memory that they will take.
    void allocate(const std::vector<Stretch>& stretches) {
        Index panel = 0, stack = 0;
        for (const Stretch& stretch : stretches) {
            for (int f = stretch.begin; f < stretch.end; ++f) {
                const FrontalMatrix front = shapeOf(symbolic_.fronts[f]);
                panel = std::max(panel, front.stride * front.width);
                stack = std::max(stack, top_ + front.contributionStride() * front.below);
                push(symbolic_.fronts[f], front);
            }
            take(stretch);
        }
        waiting_.clear();
        top_ = 0;
        panel_.resize(panel);
        scratch_.resize(panel);
        stack_.resize(stack);
    }

    bool eliminateFront(const SymbolicLdlt::Front& supernode) {
        FrontalMatrix front = shapeOf(supernode);
        front.columns = panel_.data();
        front.scratch = scratch_.data();
        front.contribution = stack_.data() + top_;
        front.parallelFor = [](std::ptrdiff_t count, void (*call)(const void*, std::ptrdiff_t),
                               const void* function) { ThreadTeam::run(count, {call, function}); };
        gather(supernode, front);
        if (!kernels().eliminateFront(front)) return false;
        store(supernode, front);
        const Index at = push(supernode, front);
        if (stack_.data() + at != front.contribution)
            std::copy_n(front.contribution, front.contributionStride() * front.below,
                        stack_.data() + at);
        return true;
    }

    /// What the root of the subtree has left: alone on the stack of the elimination that did it.
    void take(const Stretch& stretch) {
        if (stretch.subtree != nullptr && stretch.root->below > 0)
            waiting_.push_back({stretch.root, top_, stretch.subtree->stack_.data()});
    }

    /// Puts the front's part of W - sigma D into it, and what its children have left.
    void gather(const SymbolicLdlt::Front& supernode, const FrontalMatrix& front) {
        std::fill_n(front.columns, front.stride * front.width, 0.0);
        std::fill_n(front.contribution, front.contributionStride() * front.below, 0.0);
        double* rows = front.columns + front.offset;
        for (int e = supernode.entriesBegin; e < supernode.entriesEnd; ++e) {
            const SymbolicLdlt::Entry& entry = symbolic_.entries[e];
            rows[entry.column * front.stride + entry.row] = W_[entry.source];
        }
        for (Index j = 0; j < front.width; ++j)
            rows[j * front.stride + j] -= shifts_[supernode.first + j];
        for (std::size_t i = waiting_.size() - supernode.children; i < waiting_.size(); ++i)
            add(waiting_[i], front);
    }

    void add(const Waiting& child, const FrontalMatrix& front) {
        const int below = child.supernode->below, width = static_cast<int>(front.width);
        const int* places = symbolic_.places.data() + child.supernode->firstPlace;
        const Index stride = shapeOf(*child.supernode).contributionStride();
        const double* left = child.elsewhere ? child.elsewhere : stack_.data() + child.at;
        for (int j = 0; j < below; ++j) {
            const double* from = left + j * stride;
            // The column of the front, and the row that it begins with.
            const bool isEliminated = places[j] < width;
            double* to = isEliminated ? front.columns + places[j] * front.stride + front.offset
                                      : front.contribution +
                                            (places[j] - width) * front.contributionStride();
            const int first = isEliminated ? 0 : width;
            for (int i = j; i < below; ++i) to[places[i] - first] += from[i];
        }
    }

    void store(const SymbolicLdlt::Front& supernode, const FrontalMatrix& front) {
        for (Index j = 0; j < front.width; ++j) {
            const double* diagonal = front.columns + j * front.stride + front.offset + j;
            const Index column = supernode.first + j;
            numbers_.pivots[column] = *diagonal;
            std::copy_n(diagonal + 1, front.width - 1 - j + front.below,
                        numbers_.values.data() + symbolic_.valueStarts[column]);
        }
    }

    /// Takes the children from the stack, and room for what the front leaves in their place.
    /// Returns where that is.
    Index push(const SymbolicLdlt::Front& supernode, const FrontalMatrix& front) {
        for (int i = 0; i < supernode.children; ++i, waiting_.pop_back()) top_ = waiting_.back().at;
        const Index at = top_;
        if (front.below > 0) waiting_.push_back({&supernode, at, nullptr});
        top_ += front.contributionStride() * front.below;
        return at;
    }

    const SymbolicLdlt& symbolic_;
    const double* W_;
    const Eigen::VectorXd& shifts_;  // sigma D, in the order of the factor
    LdltNumbers& numbers_;
    Eigen::VectorXd panel_, scratch_;
    Eigen::VectorXd stack_;
    std::vector<Waiting> waiting_;
    Index top_ = 0;  // of the stack
};

}  // namespace

bool eliminate(const SymbolicLdlt& symbolic, const SparseMatrix& W, const Eigen::VectorXd& D,
               double sigma, LdltNumbers& numbers) {
    Eigen::VectorXd shifts(D.size());
    for (Index i = 0; i < shifts.size(); ++i) shifts[symbolic.order[i]] = sigma * D[i];
    numbers.values.resize(static_cast<std::size_t>(symbolic.valueStarts.back()));
    numbers.pivots.resize(shifts.size());

    const Elimination none(symbolic, W.valuePtr(), shifts, numbers);
    std::vector<Elimination> ofSubtree(symbolic.subtrees.size(), none);
    std::vector<Stretch> above;
    int next = 0;
    for (std::size_t t = 0; t < symbolic.subtrees.size(); ++t) {
        const SymbolicLdlt::Subtree& tree = symbolic.subtrees[t];
        above.push_back(
            {next, tree.firstFront, &ofSubtree[t], &symbolic.fronts[tree.endFront - 1]});
        next = tree.endFront;
    }
    above.push_back({next, static_cast<int>(symbolic.fronts.size()), nullptr, nullptr});

    std::vector<char> done(symbolic.subtrees.size());
    parallelFor(static_cast<Index>(done.size()), [&](Index t) {
        const SymbolicLdlt::Subtree& tree = symbolic.subtrees[t];
        done[t] = ofSubtree[t].run({{tree.firstFront, tree.endFront, nullptr, nullptr}});
    });
    if (std::find(done.begin(), done.end(), 0) != done.end()) return false;
    return Elimination(none).run(above);
}

}  // namespace spectral
