#pragma once

#include <array>
#include <vector>

namespace spectral {

/// The sides of triangle t are 3 t, 3 t + 1 and 3 t + 2, in cyclic order.
inline int nextSide(int side) { return side % 3 == 2 ? side - 2 : side + 1; }
inline int previousSide(int side) { return side % 3 == 0 ? side + 2 : side - 1; }

/// A closed triangulation given by edge lengths alone, made Delaunay by edge flips.
///
/// Every side of a triangle is glued to its oppositely directed twin; the two form an edge. Any
/// gluing is allowed: an edge may be a loop, and several edges may join the same two vertices.
class IntrinsicTriangulation {
  public:
    /// @param tail    first vertex of each side.
    /// @param twin    side glued to each side.
    /// @param length  length of each side, equal for twins; triangle inequalities hold strictly.
    IntrinsicTriangulation(std::vector<int> tail, std::vector<int> twin,
                           std::vector<double> length);

    /// Flips edges until the two cotangents opposite each sum to at least 0, up to round-off. Ends
    /// for any lengths and releases them: to be called once.
    void makeDelaunay();

    int sideCount() const { return static_cast<int>(tail_.size()); }
    int tail(int side) const { return tail_[side]; }
    int twin(int side) const { return twin_[side]; }

    /// Cotangent of the angle opposite a side.
    double cotangent(int side) const { return cotangent_[side]; }

    /// Sum of the two cotangents opposite the edge of a side.
    double edgeCotangents(int side) const { return cotangent_[side] + cotangent_[twin_[side]]; }

  private:
    void setCotangents(int side, const std::array<double, 3>& cotangents);
    double sumOfCotangents(int side) const;  // of the side's triangle
    bool isDelaunay(int side) const;
    bool flip(int side, bool isFree);

    std::vector<int> tail_, twin_;
    std::vector<double> length_;
    std::vector<double> cotangent_;
};

}  // namespace spectral
