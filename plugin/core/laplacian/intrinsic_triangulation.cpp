#include "core/laplacian/intrinsic_triangulation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/support/threads.h"
#include "core/support/types.h"

namespace spectral {

namespace {

/// An edge is flipped when its two cotangents sum to less than minus this; otherwise round-off
/// would flip nearly cocircular corners back and forth. The absolute part covers rectangles, whose
/// cotangents are zero up to round-off, the relative part needles, whose large cotangents have
/// larger errors. Both are far above round-off and bound the resulting error of W.
double flipTolerance(double a, double b) { return 1e-10 + 1e-11 * (std::abs(a) + std::abs(b)); }

/// Flips per edge after which a flip must also decrease the sum of all cotangents; one or two are
/// usual.
constexpr Index kFreeFlipsPerEdge = 10;

/// Area of a triangle from its sides, by Kahan's form of Heron's formula, stable for needles.
double triangleArea(double a, double b, double c) {
    if (a < b) std::swap(a, b);
    if (a < c) std::swap(a, c);
    if (b < c) std::swap(b, c);
    const double product = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c));
    return 0.25 * std::sqrt(std::max(0.0, product));
}

/// The cotangents of the angles opposite the sides of a triangle.
std::array<double, 3> cotangentsOf(const std::array<double, 3>& sides) {
    const auto [a, b, c] = sides;
    const double fourAreas = 4.0 * triangleArea(a, b, c);
    // b^2 + c^2 - a^2 without cancellation for the short side of a needle
    return {(b * b + (c - a) * (c + a)) / fourAreas, (c * c + (a - b) * (a + b)) / fourAreas,
            (a * a + (b - c) * (b + c)) / fourAreas};
}

double sum(const std::array<double, 3>& cotangents) {
    return cotangents[0] + cotangents[1] + cotangents[2];
}

}  // namespace

IntrinsicTriangulation::IntrinsicTriangulation(std::vector<int> tail, std::vector<int> twin,
                                               std::vector<double> length)
    : tail_(std::move(tail)),
      twin_(std::move(twin)),
      length_(std::move(length)),
      cotangent_(length_.size()) {
    parallelRows(sideCount() / 3, [&](Index begin, Index end) {
        for (Index s = 3 * begin; s < 3 * end; s += 3)
            setCotangents(static_cast<int>(s),
                          cotangentsOf({length_[s], length_[s + 1], length_[s + 2]}));
    });
}

/// Ends for any lengths. For an edge that is not Delaunay, a flip decreases the sum of all
/// cotangents (Rivin 1994), but with rounded lengths not always: flips of needles, whose corners
/// are nearly cocircular, can then repeat for ever. So after kFreeFlipsPerEdge every flip must
/// decrease the sum as computed for the two triangles. Rounding is monotone: if x + y < z + w in
/// floating-point numbers, so it is without rounding. The exact sum S of the numbers
/// `sumOfCotangents` over all triangles then decreases strictly with every flip. It takes finitely
/// many values, because there are finitely many triangulations of these vertices whose lengths are
/// floating-point numbers. An edge that is left as it is falls short of Delaunay by no more than
/// the error of its cotangents.
void IntrinsicTriangulation::makeDelaunay() {
    std::vector<int> stack;
    std::vector<char> waiting(tail_.size(), 0);
    const auto push = [&](int side) {
        const int s = std::min(side, twin_[side]);
        if (!waiting[s]) {
            waiting[s] = 1;
            stack.push_back(s);
        }
    };
    parallelRows(sideCount(), [&](Index begin, Index end) {
        for (int s = static_cast<int>(begin); s < end; ++s)
            waiting[s] = s < twin_[s] && !isDelaunay(s);
    });
    for (int s = sideCount() - 1; s >= 0; --s)
        if (waiting[s]) stack.push_back(s);
    Index freeFlips = kFreeFlipsPerEdge * (sideCount() / 2);
    while (!stack.empty()) {
        ThreadTeam::stopPoint();
        const int s = stack.back();
        stack.pop_back();
        waiting[s] = 0;
        if (isDelaunay(s)) continue;
        // A flip renumbers sides: the waiting edges around it are pushed again.
        const int t = twin_[s];
        if (!flip(s, freeFlips > 0)) continue;
        --freeFlips;
        push(s);
        for (const int outer : {nextSide(s), previousSide(s), nextSide(t), previousSide(t)})
            push(outer);
    }
    std::vector<double>().swap(length_);  // only flips need lengths
}

bool IntrinsicTriangulation::isDelaunay(int side) const {
    if (side / 3 == twin_[side] / 3) return true;  // glued to itself, cannot flip
    const double a = cotangent_[side], b = cotangent_[twin_[side]];
    return !(a + b < -flipTolerance(a, b));  // false for NaN, which no flip repairs
}

void IntrinsicTriangulation::setCotangents(int side, const std::array<double, 3>& cotangents) {
    std::copy(cotangents.begin(), cotangents.end(), cotangent_.begin() + (side - side % 3));
}

double IntrinsicTriangulation::sumOfCotangents(int side) const {
    const int s = side - side % 3;
    return sum({cotangent_[s], cotangent_[s + 1], cotangent_[s + 2]});
}

/// Turns the edge of side s = (i, j), with triangles (i, j, k) and (j, i, l), into (k, l); returns
/// false, and leaves it, when this would not decrease the sum of their cotangents and is not free.
bool IntrinsicTriangulation::flip(int s, bool isFree) {
    const int t = twin_[s];
    const std::array<int, 4> old{previousSide(t), nextSide(s), previousSide(s), nextSide(t)};
    const std::array<int, 4> slot{nextSide(s), previousSide(s), nextSide(t), previousSide(t)};
    const double lij = length_[s];
    const double ljk = length_[nextSide(s)], lki = length_[previousSide(s)];
    const double lil = length_[nextSide(t)], llj = length_[previousSide(t)];

    // Lay out both triangles in the plane: i at the origin, j on the first axis.
    const double kx = 0.5 * (lij + (lki - ljk) * (lki + ljk) / lij);
    const double lx = 0.5 * (lij + (lil - llj) * (lil + llj) / lij);
    const double ky = 2.0 * triangleArea(lij, ljk, lki) / lij;
    const double ly = -2.0 * triangleArea(lij, lil, llj) / lij;
    const double lkl =
        std::hypot(kx - lx, ky - ly);  // accurate to the last bit, as needles require

    std::array<double, 3> sidesOfS, sidesOfT;
    const auto put = [](std::array<double, 3>& sides, int side, double length) {
        sides[side % 3] = length;
    };
    put(sidesOfS, s, lkl);
    put(sidesOfS, slot[0], length_[old[0]]);
    put(sidesOfS, slot[1], length_[old[1]]);
    put(sidesOfT, t, lkl);
    put(sidesOfT, slot[2], length_[old[2]]);
    put(sidesOfT, slot[3], length_[old[3]]);
    const std::array<double, 3> ofS = cotangentsOf(sidesOfS), ofT = cotangentsOf(sidesOfT);
    // Three corners of needles may be on one line up to round-off: an infinite sum is never less.
    const double before =
        isFree ? std::numeric_limits<double>::infinity() : sumOfCotangents(s) + sumOfCotangents(t);
    if (!(sum(ofS) + sum(ofT) < before)) return false;

    const int k = tail_[previousSide(s)], l = tail_[previousSide(t)];
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
        // The twin may be another of the four outer sides, which have moved, too.
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
    setCotangents(s, ofS);
    setCotangents(t, ofT);
    return true;
}

}  // namespace spectral
