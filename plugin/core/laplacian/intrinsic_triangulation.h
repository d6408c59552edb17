#pragma once

#include <vector>

namespace spectral {

/// The sides of triangle t are 3 t, 3 t + 1 and 3 t + 2, one after the other round it.
inline int nextSide(int side) { return side % 3 == 2 ? side - 2 : side + 1; }
inline int previousSide(int side) { return side % 3 == 0 ? side + 2 : side - 1; }

/// A closed triangulation given by the lengths of its edges alone, which flips make Delaunay.
///
/// Every side of a triangle is glued to another one, its twin, which runs the other way; two glued
/// sides are an edge. Nothing else is asked of the gluing: an edge may join a vertex to itself, and
/// several edges the same two vertices.
class IntrinsicTriangulation {
  public:
    /// @param tail    vertex where each side begins.
    /// @param length  of each side, the same for twins; every triangle inequality holds strictly.
    IntrinsicTriangulation(std::vector<int> tail, std::vector<int> twin,
                           std::vector<double> length);

    /// Flips edges until each has opposite cotangents that sum to 0 or more, but for a tolerance.
    /// @throws SolverFailure  when that does not end.
    void makeDelaunay();

    int sideCount() const { return static_cast<int>(tail_.size()); }
    int tail(int side) const { return tail_[side]; }
    int twin(int side) const { return twin_[side]; }

    /// Sum of the cotangents of the two angles opposite to an edge, given by one of its sides.
    double edgeCotangents(int side) const { return cotangent_[side] + cotangent_[twin_[side]]; }

  private:
    void setCotangents(int side);
    bool isDelaunay(int side) const;
    void flip(int side);

    std::vector<int> tail_, twin_;
    std::vector<double> length_;
    std::vector<double> cotangent_;  // of the angle opposite to each side
};

}  // namespace spectral
