#include "shapes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace spectral::python {

namespace {

using Vector = Eigen::RowVector3d;

std::uint64_t hashOf(const double* row, Eigen::Index columns) {
    std::uint64_t hash = 0;
    for (Eigen::Index k = 0; k < columns; ++k) {
        const double value = row[k] == row[k] ? row[k] + 0.0 : 1.0;  // no negative zero, no payload
        std::uint64_t bits = 0;
        std::memcpy(&bits, &value, sizeof bits);
        hash ^= bits;
        hash ^= hash >> 32;           // the low bits of short numbers are all zero
        hash *= 0x9E3779B97F4A7C15U;  // 2^64 over the golden ratio
        hash ^= hash >> 32;
    }
    return hash;
}

bool areEqual(const double* a, const double* b, Eigen::Index columns) {
    const auto same = [](double x, double y) { return x == y || (x != x && y != y); };
    return std::equal(a, a + columns, b, same);
}

/// The first of the normals that are equal to each, at the same position.
std::vector<std::int64_t> groupsOf(const Rows<double>& V, const Rows<std::int64_t>& F,
                                   const Rows<double>& N, const Rows<std::int64_t>& which) {
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> keys(N.rows(), 7);
    keys.leftCols<3>() = N;
    for (Eigen::Index i = 0; i < N.rows(); ++i)
        keys.row(i).tail<4>() << 0.0, 0.0, 0.0, static_cast<double>(i + 1);  // used by no corner
    for (Eigen::Index f = 0; f < F.rows(); ++f)
        for (Eigen::Index c = 0; c < 3; ++c) keys.row(which(f, c)).tail<4>() << V.row(F(f, c)), 0.0;
    return firstEqualRows({keys.data(), keys.rows(), keys.cols()});
}

using Triangle = std::array<Vector, 3>;

Triangle triangleOf(const Rows<double>& V, const std::int64_t* corners) {
    return {V.row(corners[0]), V.row(corners[1]), V.row(corners[2])};
}

/// A normal, of length twice the area.
Vector areaVector(const Triangle& P) { return (P[1] - P[0]).cross(P[2] - P[0]); }

/// Sums of the triangles' normals at corners, by the usual weights: angles, areas, none.
using Means = std::array<Table3, 3>;

/// Adds a triangle's normal to the sums of its corners.
void addNormal(const Triangle& P, const std::array<std::int64_t, 3>& groups, Means& sums) {
    const Vector area = areaVector(P);
    const double length = area.norm();
    if (!(length > 0.0)) return;
    for (std::size_t c = 0; c < 3; ++c) {
        const double cosine = (P[(c + 1) % 3] - P[c]).dot(P[(c + 2) % 3] - P[c]);
        sums[0].row(groups[c]) += std::atan2(length, cosine) / length * area;
        sums[1].row(groups[c]) += area;
        sums[2].row(groups[c]) += area / length;
    }
}

/// A vector after the least rotation from one unit vector to another; its unit vector.
Vector rotated(const Vector& vector, const Vector& from, const Vector& to) {
    constexpr double kOpposite = 1e-6;  // then any axis would do
    const double cosine = from.dot(to);
    if (cosine < kOpposite - 1.0) return (vector.dot(from) < 0.0 ? -1.0 : 1.0) * to;
    const Vector axis = from.cross(to);
    const Vector across = axis.cross(vector);
    return (vector + across + axis.cross(across) / (1.0 + cosine)).normalized();
}

/// A new normal's unit vector, on the side of the surface where the given one was.
Vector turned(const Vector& normal, const Vector& given, const Vector& before) {
    return (given.dot(before) < 0.0 ? -1.0 : 1.0) / normal.norm() * normal;
}

}  // namespace

std::vector<std::int64_t> firstEqualRows(const Rows<double>& rows) {
    const Eigen::Index n = rows.rows(), columns = rows.cols();
    std::size_t size = 16;
    while (size < 2 * static_cast<std::size_t>(n)) size *= 2;
    std::vector<std::int64_t> first(n), table(size, -1);
    for (Eigen::Index i = 0; i < n; ++i) {
        const double* const row = rows.data() + i * columns;
        std::size_t slot = hashOf(row, columns) & (size - 1);
        while (table[slot] >= 0 && !areEqual(rows.data() + table[slot] * columns, row, columns))
            slot = (slot + 1) & (size - 1);
        if (table[slot] < 0) table[slot] = i;
        first[i] = table[slot];
    }
    return first;
}

Table3 followingNormals(const Rows<double>& before, const Rows<double>& after,
                        const Rows<std::int64_t>& F, const Rows<double>& N,
                        const Rows<std::int64_t>& which) {
    const std::vector<std::int64_t> groups = groupsOf(before, F, N, which);
    Table3 given = Table3::Zero(N.rows(), 3);
    Means old{given, given, given}, sums = old;
    std::vector<bool> hasMoved(N.rows(), false);
    for (Eigen::Index i = 0; i < N.rows(); ++i) given.row(groups[i]) += N.row(i);
    for (Eigen::Index f = 0; f < F.rows(); ++f) {
        const std::array<std::int64_t, 3> group{groups[which(f, 0)], groups[which(f, 1)],
                                                groups[which(f, 2)]};
        const Triangle was = triangleOf(before, F.data() + 3 * f);
        const Triangle is = triangleOf(after, F.data() + 3 * f);
        addNormal(was, group, old);
        addNormal(is, group, sums);
        for (const std::int64_t one : group) hasMoved[one] = hasMoved[one] || is != was;
    }
    Table3 result = N;
    for (Eigen::Index i = 0; i < N.rows(); ++i) {
        const std::int64_t group = groups[i];
        if (!hasMoved[group]) continue;
        const Vector normal = given.row(group).normalized();
        const Table3 *nearest = nullptr, *moved = nullptr;
        double most = -1.0;
        for (std::size_t k = 0; k < old.size(); ++k) {
            if (!(old[k].row(group).norm() > 0.0 && sums[k].row(group).norm() > 0.0)) continue;
            const double cosine = std::abs(normal.dot(old[k].row(group).normalized()));
            if (cosine <= most) continue;
            most = cosine;
            nearest = &old[k];
            moved = &sums[k];
        }
        if (nearest == nullptr) continue;
        const Vector from = nearest->row(group).normalized(), to = moved->row(group).normalized();
        const bool isNone = N.row(i).isZero(0.0);
        result.row(i) = isNone ? to : rotated(N.row(i), from, to);
    }
    return result;
}

Table3 followingFaceNormals(const Rows<double>& before, const Rows<double>& after,
                            const Rows<std::int64_t>& F, const Rows<double>& N,
                            const std::int64_t* owners) {
    Table3 old = Table3::Zero(N.rows(), 3), sums = old, result = N;
    std::vector<bool> hasMoved(N.rows(), false);
    for (Eigen::Index f = 0; f < F.rows(); ++f) {
        const Triangle was = triangleOf(before, F.data() + 3 * f);
        const Triangle is = triangleOf(after, F.data() + 3 * f);
        old.row(owners[f]) += areaVector(was);
        sums.row(owners[f]) += areaVector(is);
        if (is != was) hasMoved[owners[f]] = true;
    }
    for (Eigen::Index i = 0; i < N.rows(); ++i)
        if (hasMoved[i] && sums.row(i).norm() > 0.0 && (N.row(i).array() != 0.0).any())
            result.row(i) = turned(sums.row(i), N.row(i), old.row(i));
    return result;
}

}  // namespace spectral::python
