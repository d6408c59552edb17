#include "shapes.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>

namespace spectral::python {

namespace {

using Vector = Eigen::RowVector3d;

std::uint64_t hashOf(const double* row, Eigen::Index columns) {
    std::uint64_t hash = 0;
    for (Eigen::Index k = 0; k < columns; ++k) {
        const double value = row[k] + 0.0;  // no negative zero
        std::uint64_t bits = 0;
        std::memcpy(&bits, &value, sizeof bits);
        hash = (hash ^ bits) * 0x9E3779B97F4A7C15U;  // 2^64 over the golden ratio
        hash ^= hash >> 29;
    }
    return hash;
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

/// Adds a triangle's unit normal to those of its corners, weighted with their angles.
void addNormal(const Rows<double>& V, const std::int64_t* corners, const std::int64_t* groups,
               Table3& sums) {
    const Vector P[3] = {V.row(corners[0]), V.row(corners[1]), V.row(corners[2])};
    const Vector area = (P[1] - P[0]).cross(P[2] - P[0]);
    const double length = area.norm();
    if (!(length > 0.0)) return;
    for (int c = 0; c < 3; ++c) {
        const double cosine = (P[(c + 1) % 3] - P[c]).dot(P[(c + 2) % 3] - P[c]);
        sums.row(groups[c]) += std::atan2(length, cosine) / length * area;
    }
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
        while (table[slot] >= 0 && rows.row(table[slot]) != rows.row(i))
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
    Table3 given = Table3::Zero(N.rows(), 3), was = given, is = given;
    std::vector<bool> hasMoved(N.rows(), false);
    for (Eigen::Index i = 0; i < N.rows(); ++i) given.row(groups[i]) += N.row(i);
    for (Eigen::Index f = 0; f < F.rows(); ++f) {
        const std::int64_t group[3] = {groups[which(f, 0)], groups[which(f, 1)],
                                       groups[which(f, 2)]};
        const std::int64_t* const corners = F.data() + 3 * f;
        addNormal(before, corners, group, was);
        addNormal(after, corners, group, is);
        bool moves = false;
        for (int c = 0; c < 3; ++c) moves |= before.row(corners[c]) != after.row(corners[c]);
        for (int c = 0; c < 3; ++c) hasMoved[group[c]] = hasMoved[group[c]] || moves;
    }
    Table3 result = N;
    for (Eigen::Index i = 0; i < N.rows(); ++i) {
        const std::int64_t group = groups[i];
        const double length = is.row(group).norm();
        if (!hasMoved[group] || !(length > 0.0)) continue;
        // The file's normals may disagree with the orientation of its faces.
        const double side = given.row(group).dot(was.row(group)) < 0.0 ? -1.0 : 1.0;
        result.row(i) = side / length * is.row(group);
    }
    return result;
}

}  // namespace spectral::python
