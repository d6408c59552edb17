#include "intrinsic_delaunay.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace spectral {

namespace {

/// Mollification, in mean edge lengths: by how much two sides of a triangle are at least longer
/// than the third. Sharp and Crane's value.
constexpr double kMollification = 1e-5;

/// An edge is flipped when the sum of its two cotangents is below minus this part of their moduli:
/// nearly cocircular corners would otherwise be flipped to and fro by round-off.
constexpr double kFlipTolerance = 1e-11;

/// Flips per edge after which the rest is left; a few are usual.
constexpr long kMaxFlipsPerEdge = 100;

int next(int side) { return side % 3 == 2 ? side - 2 : side + 1; }
int previous(int side) { return side % 3 == 0 ? side + 2 : side - 1; }

/// A triangle's side, in the mesh, with the edge that it lies on.
struct EdgeSide {
    int low, high;  // vertices, low < high
    int side;
    bool operator<(const EdgeSide& other) const {
        return std::array{low, high, side} < std::array{other.low, other.high, other.side};
    }
};

std::vector<EdgeSide> sidesByEdge(const Faces& F) {
    std::vector<EdgeSide> sides;
    sides.reserve(static_cast<std::size_t>(3 * F.rows()));
    for (int t = 0; t < F.rows(); ++t)
        for (int c = 0; c < 3; ++c) {
            const int i = F(t, c), j = F(t, (c + 1) % 3);
            sides.push_back({std::min(i, j), std::max(i, j), 3 * t + c});
        }
    std::sort(sides.begin(), sides.end());
    return sides;
}

/// Orders the sides of one edge by the angle of their triangles round it.
void sortByAngle(const Vertices& V, const Faces& F, EdgeSide* first, EdgeSide* last) {
    const Eigen::RowVector3d origin = V.row(first->low);
    const Eigen::RowVector3d axis = (V.row(first->high) - origin).normalized();
    const Eigen::RowVector3d right = axis.unitOrthogonal(), up = axis.cross(right);
    const auto angle = [&](const EdgeSide& s) {
        const Eigen::RowVector3d spoke = V.row(F(s.side / 3, (s.side + 2) % 3)) - origin;
        const double theta = std::atan2(spoke.dot(up), spoke.dot(right));
        return std::isfinite(theta) ? theta : 0.0;  // an edge without length has no angles
    };
    // Duplicates of a triangle lie at the same angle. They are layered alike on all three edges, by
    // their index along the normal of their sorted corners: the sheets between them stay apart.
    const auto layer = [&](const EdgeSide& s) {
        const int opposite = F(s.side / 3, (s.side + 2) % 3);
        const bool againstNormal = s.low < opposite && opposite < s.high;
        return againstNormal ? -s.side : s.side;
    };
    std::sort(first, last, [&](const EdgeSide& a, const EdgeSide& b) {
        return std::pair(angle(a), layer(a)) < std::pair(angle(b), layer(b));
    });
}

/// Triangle areas and cotangents from three lengths.
struct Triangle {
    double area, cotangent;  // of the angle opposite to the first length

    /// Heron's formula, in Kahan's form that keeps its digits for needles.
    static double areaOf(double a, double b, double c) {
        if (a < b) std::swap(a, b);
        if (a < c) std::swap(a, c);
        if (b < c) std::swap(b, c);
        const double product = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c));
        return 0.25 * std::sqrt(std::max(0.0, product));
    }

    Triangle(double opposite, double b, double c)
        : area(areaOf(opposite, b, c)),
          // b^2 + c^2 - a^2 without cancelling the digits of a needle's short side
          cotangent((b * b + (c - opposite) * (c + opposite)) / (4.0 * area)) {}
};

/// A triangulation by lengths alone, closed, that edge flips make Delaunay.
class IntrinsicTriangulation {
  public:
    IntrinsicTriangulation(std::vector<int> tail, std::vector<int> twin, std::vector<double> length)
        : tail_(std::move(tail)), twin_(std::move(twin)), length_(std::move(length)) {}

    void makeDelaunay() {
        const int sides = static_cast<int>(tail_.size());
        std::vector<int> stack;
        std::vector<char> waiting(tail_.size(), 0);
        const auto push = [&](int side) {
            const int s = std::min(side, twin_[side]);
            if (!waiting[s]) {
                waiting[s] = 1;
                stack.push_back(s);
            }
        };
        for (int s = sides - 1; s >= 0; --s) push(s);
        long flips = kMaxFlipsPerEdge * sides / 2;
        while (!stack.empty() && flips > 0) {
            const int s = stack.back();
            stack.pop_back();
            waiting[s] = 0;
            if (isDelaunay(s)) continue;
            // A side that waits may now be another edge; the edge that it was is pushed again.
            const int t = twin_[s];
            flip(s);
            --flips;
            push(s);
            for (const int outer : {next(s), previous(s), next(t), previous(t)}) push(outer);
        }
    }

    /// Sum of the cotangents opposite to an edge.
    double edgeCotangents(int s) const { return cotangent(s) + cotangent(twin_[s]); }

    int sideCount() const { return static_cast<int>(tail_.size()); }
    int tail(int side) const { return tail_[side]; }
    int twin(int side) const { return twin_[side]; }

  private:
    double cotangent(int s) const {
        return Triangle(length_[s], length_[next(s)], length_[previous(s)]).cotangent;
    }

    bool isDelaunay(int s) const {
        if (s / 3 == twin_[s] / 3) return true;  // a triangle glued to itself has nothing to flip
        const double a = cotangent(s), b = cotangent(twin_[s]);
        return a + b >= -kFlipTolerance * (std::abs(a) + std::abs(b));
    }

    /// Turns the edge of side s = (i, j), with triangles (i, j, k) and (j, i, l), into (k, l).
    void flip(int s) {
        const int t = twin_[s];
        const std::array<int, 4> old{previous(t), next(s), previous(s), next(t)};
        const std::array<int, 4> slot{next(s), previous(s), next(t), previous(t)};
        const double lij = length_[s];
        const double ljk = length_[next(s)], lki = length_[previous(s)];
        const double lil = length_[next(t)], llj = length_[previous(t)];

        // Both triangles laid out in the plane, i in the origin, j on the first axis.
        const double kx = 0.5 * (lij + (lki - ljk) * (lki + ljk) / lij);
        const double lx = 0.5 * (lij + (lil - llj) * (lil + llj) / lij);
        const double ky = 2.0 * Triangle::areaOf(lij, ljk, lki) / lij;
        const double ly = -2.0 * Triangle::areaOf(lij, lil, llj) / lij;
        const double lkl = std::hypot(kx - lx, ky - ly);

        const int k = tail_[previous(s)], l = tail_[previous(t)];
        std::array<int, 4> tails, twins;
        std::array<double, 4> lengths;
        for (int q = 0; q < 4; ++q) {
            tails[q] = tail_[old[q]];
            twins[q] = twin_[old[q]];
            lengths[q] = length_[old[q]];
        }
        for (int q = 0; q < 4; ++q) {
            tail_[slot[q]] = tails[q];
            length_[slot[q]] = lengths[q];
            // An outer side may be glued to another one of the four, which has moved too.
            const auto moved = std::find(old.begin(), old.end(), twins[q]);
            if (moved != old.end()) {
                twin_[slot[q]] = slot[moved - old.begin()];
            } else {
                twin_[slot[q]] = twins[q];
                twin_[twins[q]] = slot[q];
            }
        }
        tail_[s] = k;
        tail_[t] = l;
        length_[s] = length_[t] = lkl;
    }

    std::vector<int> tail_, twin_;
    std::vector<double> length_;
};

}  // namespace

IntrinsicDelaunay::IntrinsicDelaunay(const Vertices& V, const Faces& F) : vertexCount_(V.rows()) {
    std::vector<EdgeSide> sides = sidesByEdge(F);
    const int front = static_cast<int>(3 * F.rows());
    const auto runsUp = [&](const EdgeSide& s) { return F(s.side / 3, s.side % 3) == s.low; };
    const auto endOfEdge = [&](std::size_t begin) {
        std::size_t end = begin;
        while (end < sides.size() && sides[end].low == sides[begin].low &&
               sides[end].high == sides[begin].high)
            ++end;
        return end;
    };

    bool closedAndOriented = true;
    for (std::size_t begin = 0; begin < sides.size();) {
        const std::size_t end = endOfEdge(begin);
        oneSide_.push_back(sides[begin].side);
        closedAndOriented = closedAndOriented && end - begin == 2 &&
                            runsUp(sides[begin]) != runsUp(sides[begin + 1]);
        begin = end;
    }
    copies_ = closedAndOriented ? 1 : 2;

    tail_.resize(static_cast<std::size_t>(copies_) * front);
    twin_.resize(tail_.size());
    for (int s = 0; s < front; ++s) tail_[s] = F(s / 3, s % 3);
    if (copies_ == 1) {
        for (std::size_t e = 0; e < sides.size(); e += 2) {
            twin_[sides[e].side] = sides[e + 1].side;
            twin_[sides[e + 1].side] = sides[e].side;
        }
        return;
    }

    // The back of a triangle (a, b, c) is (a, c, b): its side 2 - s lies on the front's side s.
    const auto back = [front](int side) { return front + 3 * (side / 3) + 2 - side % 3; };
    for (int s = 0; s < front; ++s) tail_[back(s)] = F(s / 3, (s + 1 - 3 * (s / 3)) % 3);
    for (std::size_t begin = 0; begin < sides.size();) {
        const std::size_t end = endOfEdge(begin);
        if (end - begin > 2) sortByAngle(V, F, sides.data() + begin, sides.data() + end);
        // The copy that runs up the edge faces growing angles, so it meets the next triangle's copy
        // that runs down. The only triangle of a boundary edge meets its own back.
        for (std::size_t e = begin; e < end; ++e) {
            const EdgeSide& here = sides[e];
            const EdgeSide& there = sides[e + 1 < end ? e + 1 : begin];
            const int up = runsUp(here) ? here.side : back(here.side);
            const int down = runsUp(there) ? back(there.side) : there.side;
            twin_[up] = down;
            twin_[down] = up;
        }
        begin = end;
    }
}

SparseMatrix IntrinsicDelaunay::stiffness(const Vertices& V) const {
    std::vector<double> length(tail_.size());
    for (std::size_t s = 0; s < tail_.size(); ++s)
        length[s] = (V.row(tail_[next(static_cast<int>(s))]) - V.row(tail_[s])).norm();

    // Mollification: the least that makes every triangle inequality hold by the margin.
    double meanLength = 0.0;
    for (const int s : oneSide_) meanLength += length[s];
    meanLength /= static_cast<double>(oneSide_.size());
    double epsilon = 0.0;
    for (int s = 0; s < static_cast<int>(tail_.size()); ++s)
        epsilon = std::max(epsilon, length[s] - length[next(s)] - length[previous(s)] +
                                        kMollification * meanLength);
    for (double& l : length) l += epsilon;

    IntrinsicTriangulation triangulation(tail_, twin_, std::move(length));
    triangulation.makeDelaunay();

    const double share = 1.0 / copies_;
    Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(vertexCount_);
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(tail_.size() + static_cast<std::size_t>(vertexCount_));
    for (int s = 0; s < triangulation.sideCount(); ++s) {
        const int t = triangulation.twin(s), i = triangulation.tail(s), j = triangulation.tail(t);
        // An edge from a vertex to itself carries no difference.
        if (s > t || i == j) continue;
        const double w = share * 0.5 * std::max(0.0, triangulation.edgeCotangents(s));
        entries.emplace_back(i, j, -w);
        entries.emplace_back(j, i, -w);
        diagonal[i] += w;
        diagonal[j] += w;
    }
    for (int i = 0; i < vertexCount_; ++i) entries.emplace_back(i, i, diagonal[i]);
    SparseMatrix W(vertexCount_, vertexCount_);
    W.setFromTriplets(entries.begin(), entries.end());
    return W;
}

}  // namespace spectral
