#include "core/ldlt/ldlt_elimination.h"

#include <algorithm>
#include <cstddef>

#include "core/ldlt/kernels.h"
#include "core/support/threads.h"

namespace spectral {

namespace {

/// Fronts between two calls of the stop point: a fraction of a millisecond.
constexpr int kFrontsPerStopPoint = 64;

/// The layout of a supernode's frontal matrix, without memory.
FrontalMatrix shapeOf(const SymbolicLdlt::Front& supernode) {
    const auto padded = [](Index rows) { return (rows + kLane - 1) / kLane * kLane; };
    FrontalMatrix front;
    front.width = supernode.width;
    front.below = supernode.below;
    front.offset = padded(front.width) - front.width;
    front.stride = front.offset + front.width + padded(front.below);
    return front;
}

/// A contribution block that its parent has not yet assembled.
struct PendingBlock {
    const SymbolicLdlt::Front* supernode = nullptr;
    Index at = 0;                       // position on the stack of this elimination, or
    const double* elsewhere = nullptr;  // address of the block of a completed subtree
};

/// Consecutive fronts, followed by a subtree that another elimination has completed.
struct FrontRange {
    int begin = 0, end = 0;
    const SymbolicLdlt::Front* root = nullptr;  // root of the subtree, or null
    const double* contribution = nullptr;       // its contribution block
};

void require(Index size, Eigen::VectorXd& memory) {
    if (memory.size() < size) memory.resize(size);
}

/// Eliminates ranges of fronts from the leaves up. A stack holds the pending contribution blocks.
class Elimination {
  public:
    Elimination(const SymbolicLdlt& symbolic, const double* W, const Eigen::VectorXd& shifts,
                LdltNumbers& numbers, const StopPoint& stop)
        : symbolic_(symbolic),
          W_(W),
          shifts_(shifts),
          numbers_(numbers),
          stop_(stop),
          columns_(workspace().columns),
          scratch_(workspace().scratch),
          stack_(workspace().stack) {}

    /// The contribution block of the last front, valid until the workspace is used again.
    Eigen::VectorXd contribution() const {
        if (pending_.empty()) return {};
        const Index at = pending_.back().at;
        return stack_.segment(at, top_ - at);
    }

    /// False when a pivot is 0.
    bool run(const std::vector<FrontRange>& ranges) {
        allocate(ranges);
        for (const FrontRange& range : ranges) {
            for (int f = range.begin; f < range.end; ++f) {
                if (stop_ && f % kFrontsPerStopPoint == 0 && ThreadTeam::threadIndex() == 0)
                    stop_();
                if (!eliminateFront(symbolic_.fronts[f])) return false;
            }
            pushSubtree(range);
        }
        return true;
    }

  private:
    LdltNumbers::Workspace& workspace() { return numbers_.workspaces[ThreadTeam::threadIndex()]; }

    /// Makes the workspace large enough for these fronts.
    void allocate(const std::vector<FrontRange>& ranges) {
        Index columns = 0, stack = 0;
        for (const FrontRange& range : ranges) {
            for (int f = range.begin; f < range.end; ++f) {
                const FrontalMatrix front = shapeOf(symbolic_.fronts[f]);
                columns = std::max(columns, front.stride * front.width);
                stack = std::max(stack, top_ + front.contributionStride() * front.below);
                push(symbolic_.fronts[f], front);
            }
            pushSubtree(range);
        }
        pending_.clear();
        top_ = 0;
        require(columns, columns_);
        require(columns, scratch_);
        require(stack, stack_);
    }

    bool eliminateFront(const SymbolicLdlt::Front& supernode) {
        FrontalMatrix front = shapeOf(supernode);
        front.columns = columns_.data();
        front.scratch = scratch_.data();
        front.contribution = stack_.data() + top_;
        front.parallelFor = [](std::ptrdiff_t count, void (*call)(const void*, std::ptrdiff_t),
                               const void* function) { ThreadTeam::run(count, {call, function}); };
        assemble(supernode, front);
        if (!kernels().eliminateFront(front)) return false;
        store(supernode, front);
        const Index at = push(supernode, front);
        if (stack_.data() + at != front.contribution)
            std::copy_n(front.contribution, front.contributionStride() * front.below,
                        stack_.data() + at);
        return true;
    }

    /// Adds the contribution block of the subtree's root.
    void pushSubtree(const FrontRange& range) {
        if (range.root != nullptr && range.root->below > 0)
            pending_.push_back({range.root, top_, range.contribution});
    }

    /// Sets the front to its part of W - sigma D plus the contribution blocks of its children.
    void assemble(const SymbolicLdlt::Front& supernode, const FrontalMatrix& front) {
        std::fill_n(front.columns, front.stride * front.width, 0.0);
        std::fill_n(front.contribution, front.contributionStride() * front.below, 0.0);
        double* rows = front.columns + front.offset;
        for (int e = supernode.entriesBegin; e < supernode.entriesEnd; ++e) {
            const SymbolicLdlt::Entry& entry = symbolic_.entries[e];
            rows[entry.column * front.stride + entry.row] = W_[entry.source];
        }
        for (Index j = 0; j < front.width; ++j)
            rows[j * front.stride + j] -= shifts_[supernode.first + j];
        for (std::size_t i = pending_.size() - supernode.children; i < pending_.size(); ++i)
            assembleChild(pending_[i], front);
    }

    void assembleChild(const PendingBlock& child, const FrontalMatrix& front) {
        const int below = child.supernode->below, width = static_cast<int>(front.width);
        const int* places = symbolic_.places.data() + child.supernode->firstPlace;
        const Index stride = shapeOf(*child.supernode).contributionStride();
        const double* block = child.elsewhere ? child.elsewhere : stack_.data() + child.at;
        for (int j = 0; j < below; ++j) {
            const double* from = block + j * stride;
            // The target column in the front, and its first row.
            const bool isPivot = places[j] < width;
            double* to =
                isPivot ? front.columns + places[j] * front.stride + front.offset
                        : front.contribution + (places[j] - width) * front.contributionStride();
            const int first = isPivot ? 0 : width;
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

    /// Replaces a front's children on the stack with its contribution block; returns the position.
    Index push(const SymbolicLdlt::Front& supernode, const FrontalMatrix& front) {
        for (int i = 0; i < supernode.children; ++i, pending_.pop_back()) top_ = pending_.back().at;
        const Index at = top_;
        if (front.below > 0) pending_.push_back({&supernode, at, nullptr});
        top_ += front.contributionStride() * front.below;
        return at;
    }

    const SymbolicLdlt& symbolic_;
    const double* W_;
    const Eigen::VectorXd& shifts_;  // sigma D, in the order of the factor
    LdltNumbers& numbers_;
    const StopPoint& stop_;
    Eigen::VectorXd &columns_, &scratch_, &stack_;
    std::vector<PendingBlock> pending_;
    Index top_ = 0;  // top of the stack
};

}  // namespace

bool eliminate(const SymbolicLdlt& symbolic, const SparseMatrix& W, const Eigen::VectorXd& D,
               double sigma, LdltNumbers& numbers, const StopPoint& stop) {
    Eigen::VectorXd shifts(D.size());
    for (Index i = 0; i < shifts.size(); ++i) shifts[symbolic.order[i]] = sigma * D[i];
    numbers.values.resize(static_cast<std::size_t>(symbolic.valueStarts.back()));
    numbers.pivots.resize(shifts.size());

    // Within a task of a team, all tasks run on the calling thread.
    const int threads = std::max(ThreadTeam::size(), ThreadTeam::threadIndex() + 1);
    if (numbers.workspaces.size() < static_cast<std::size_t>(threads))
        numbers.workspaces.resize(static_cast<std::size_t>(threads));
    std::vector<char> done(symbolic.subtrees.size());
    std::vector<Eigen::VectorXd> contributions(symbolic.subtrees.size());
    parallelFor(static_cast<Index>(done.size()), [&](Index task) {
        const int t = symbolic.largestFirst[task];
        const SymbolicLdlt::Subtree& tree = symbolic.subtrees[t];
        Elimination subtree(symbolic, W.valuePtr(), shifts, numbers, stop);
        done[t] = subtree.run({{tree.firstFront, tree.endFront, nullptr, nullptr}});
        contributions[t] = subtree.contribution();
    });
    if (std::find(done.begin(), done.end(), 0) != done.end()) return false;

    std::vector<FrontRange> above;
    int next = 0;
    for (std::size_t t = 0; t < symbolic.subtrees.size(); ++t) {
        const SymbolicLdlt::Subtree& tree = symbolic.subtrees[t];
        above.push_back(
            {next, tree.firstFront, &symbolic.fronts[tree.endFront - 1], contributions[t].data()});
        next = tree.endFront;
    }
    above.push_back({next, static_cast<int>(symbolic.fronts.size()), nullptr, nullptr});
    return Elimination(symbolic, W.valuePtr(), shifts, numbers, stop).run(above);
}

}  // namespace spectral
