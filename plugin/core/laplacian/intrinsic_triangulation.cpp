#include "core/laplacian/intrinsic_triangulation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "core/support/errors.h"
#include "core/support/threads.h"
#include "core/support/types.h"

namespace spectral {

namespace {

/// An edge is flipped when its two cotangents sum to less than minus this; otherwise round-off
/// would flip nearly cocircular corners back and forth. The absolute part covers rectangles, whose
/// cotangents are zero up to round-off, the relative part needles, whose large cotangents have
/// larger errors. Both are far above round-off and bound the resulting error of W.
double flipTolerance(double a, double b) { return 1e-10 + 1e-11 * (std::abs(a) + std::abs(b)); }

/// Flips per edge before giving up; one or two are usual.
constexpr Index kMaxFlipsPerEdge = 100;

/// Area of a triangle from its sides, by Kahan's form of Heron's formula, stable for needles.
double triangleArea(double a, double b, double c) {
    if (a < b) std::swap(a, b);
    if (a < c) std::swap(a, c);
    if (b < c) std::swap(b, c);
    const double product = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c));
    return 0.25 * std::sqrt(std::max(0.0, product));
}

}  // namespace

IntrinsicTriangulation::IntrinsicTriangulation(std::vector<int> tail, std::vector<int> twin,
                                               std::vector<double> length)
    : tail_(std::move(tail)),
      twin_(std::move(twin)),
      length_(std::move(length)),
      cotangent_(length_.size()) {
    parallelRows(sideCount() / 3, [&](Index begin, Index end) {
        for (Index t = begin; t < end; ++t) setCotangents(static_cast<int>(3 * t));
    });
}

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
    const Index edges = sideCount() / 2;
    Index flips = 0;
    while (!stack.empty()) {
        ThreadTeam::stopPoint();
        const int s = stack.back();
        stack.pop_back();
        waiting[s] = 0;
        if (isDelaunay(s)) continue;
        if (flips++ == kMaxFlipsPerEdge * edges)
            throw SolverFailure(ErrorCode::NoDelaunay,
                                "no intrinsic Delaunay triangulation after " +
                                    std::to_string(flips) + " flips of " + std::to_string(edges) +
                                    " edges: triangles are degenerate");
        // A flip renumbers sides: the waiting edges around it are pushed again.
        const int t = twin_[s];
        flip(s);
        push(s);
        for (const int outer : {nextSide(s), previousSide(s), nextSide(t), previousSide(t)})
            push(outer);
    }
}

/// The cotangents of the three angles of a side's triangle.
void IntrinsicTriangulation::setCotangents(int side) {
    const int s = side - side % 3;
    const double a = length_[s], b = length_[s + 1], c = length_[s + 2];
    const double fourAreas = 4.0 * triangleArea(a, b, c);
    // b^2 + c^2 - a^2 without cancellation for the short side of a needle
    cotangent_[s] = (b * b + (c - a) * (c + a)) / fourAreas;
    cotangent_[s + 1] = (c * c + (a - b) * (a + b)) / fourAreas;
    cotangent_[s + 2] = (a * a + (b - c) * (b + c)) / fourAreas;
}

bool IntrinsicTriangulation::isDelaunay(int side) const {
    if (side / 3 == twin_[side] / 3) return true;  // glued to itself, cannot flip
    const double a = cotangent_[side], b = cotangent_[twin_[side]];
    return !(a + b < -flipTolerance(a, b));  // false for NaN, which no flip repairs
}

/// Turns the edge of side s = (i, j), with triangles (i, j, k) and (j, i, l), into (k, l).
void IntrinsicTriangulation::flip(int s) {
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
    setCotangents(s);
    setCotangents(t);
}

}  // namespace spectral
