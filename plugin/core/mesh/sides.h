#pragma once

#include <vector>

#include "core/mesh/mesh.h"
#include "core/support/threads.h"

namespace spectral {

/// A side of a triangle.
struct Side {
    int low, high;  ///< Its vertices, low <= high.
    int number;     ///< 3 face + corner.

    int face() const { return number / 3; }
    int corner() const { return number % 3; }          ///< Corner it starts from, 0 to 2.
    int opposite() const { return (number + 2) % 3; }  ///< Corner opposite it, 0 to 2.
};

/// All sides of all triangles, sorted by lower vertex, then higher vertex, then face: the sides of
/// an edge are consecutive.
class SidesByEdge {
  public:
    explicit SidesByEdge(const Faces& F);

    /// Calls work(first, end) with the sides of every edge, in order.
    template <class Work>
    void forEachEdge(const Work& work) const {
        visit(sides_.data(), sides_.data() + sides_.size(), work);
    }

    /// The same in parallel, in any order.
    template <class Work>
    void forEachEdgeInParallel(const Work& work) const {
        parallelRows(static_cast<Index>(begin_.size()) - 1, [&](Index from, Index to) {
            visit(sides_.data() + begin_[from], sides_.data() + begin_[to], work);
        });
    }

  private:
    template <class SidePointer, class Work>
    static void visit(SidePointer first, SidePointer end, const Work& work) {
        while (first != end) {
            SidePointer next = first + 1;
            while (next != end && next->low == first->low && next->high == first->high) ++next;
            work(first, next);
            first = next;
        }
    }

    std::vector<Side> sides_;
    std::vector<int> begin_;  // first side of each lower vertex, and the number of sides
};

}  // namespace spectral
