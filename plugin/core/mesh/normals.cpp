#include "core/mesh/normals.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/support/threads.h"

namespace spectral {

namespace {

// Sums from left to right, like VCG: Eigen's results differ in the last bits.
template <class Vector>
auto dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <class Vector>
Vector normalized(const Vector& a) {
    const auto length = std::sqrt(dot(a, a));
    return length > 0 ? Vector(a / length) : a;
}

}  // namespace

template <class Scalar>
Normals<Scalar> angleWeightedNormals(const Vertices& V, const Faces& F) {
    using Vector = Eigen::Matrix<Scalar, 1, 3>;
    Normals<Scalar> normals;
    normals.faces.resize(F.rows(), 3);
    typename Normals<Scalar>::Rows angles(F.rows(), 3);
    parallelRows(F.rows(), [&](Index begin, Index end) {
        for (Index t = begin; t < end; ++t) {
            Vector p[3], edge[3];  // from each corner to the next
            for (int c = 0; c < 3; ++c) p[c] = V.row(F(t, c)).template cast<Scalar>();
            for (int c = 0; c < 3; ++c) edge[c] = normalized(Vector(p[(c + 1) % 3] - p[c]));
            normals.faces.row(t) = normalized(Vector((p[1] - p[0]).cross(p[2] - p[0])));
            for (int c = 0; c < 3; ++c)
                angles(t, c) = std::acos(std::clamp<Scalar>(
                    dot(edge[c], Vector(-edge[(c + 2) % 3])), Scalar{-1}, Scalar{1}));
        }
    });
    normals.vertices = Normals<Scalar>::Rows::Zero(V.rows(), 3);
    for (Index t = 0; t < F.rows(); ++t)
        for (int c = 0; c < 3; ++c)
            normals.vertices.row(F(t, c)) += normals.faces.row(t) * angles(t, c);
    return normals;
}

template Normals<float> angleWeightedNormals<float>(const Vertices&, const Faces&);
template Normals<double> angleWeightedNormals<double>(const Vertices&, const Faces&);

}  // namespace spectral
