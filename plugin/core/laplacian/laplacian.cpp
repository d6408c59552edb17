#include "core/laplacian/laplacian.h"

#include <Eigen/Geometry>
#include <cmath>
#include <utility>
#include <vector>

#include "core/support/threads.h"

namespace spectral {

namespace {

/// W with the weights (cot a_ij + cot b_ij)/2.
/// @param cotangents  (t, c) -> cotangent of the angle at corner c of triangle t.
template <class Cotangents>
SparseMatrix stiffnessOf(Index n, const Faces& F, const Cotangents& cotangents) {
    Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(n);
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(static_cast<std::size_t>(6 * F.rows() + n));
    for (Index t = 0; t < F.rows(); ++t) {
        for (int c = 0; c < 3; ++c) {
            // The angle at corner c lies opposite to the edge (i, j).
            const int i = F(t, (c + 1) % 3), j = F(t, (c + 2) % 3);
            const double w = 0.5 * cotangents(t, c);
            entries.emplace_back(i, j, -w);
            entries.emplace_back(j, i, -w);
            diagonal[i] += w;
            diagonal[j] += w;
        }
    }
    for (int i = 0; i < n; ++i) entries.emplace_back(i, i, diagonal[i]);
    SparseMatrix W(n, n);
    W.setFromTriplets(entries.begin(), entries.end());
    return W;
}

}  // namespace

Laplacian cotangentLaplacian(const Vertices& V, const Faces& F) {
    const auto cotangent = [&](Index t, int c) {
        const Eigen::RowVector3d corner = V.row(F(t, c));
        const Eigen::RowVector3d a = V.row(F(t, (c + 1) % 3)) - corner;
        const Eigen::RowVector3d b = V.row(F(t, (c + 2) % 3)) - corner;
        return a.dot(b) / a.cross(b).norm();
    };
    return {stiffnessOf(V.rows(), F, cotangent), lumpedMass(V, F)};
}

Laplacian uniformLaplacian(const Vertices& V, const Faces& F) {
    const double cotangentOf60Degrees = 1.0 / std::sqrt(3.0);
    SparseMatrix W = stiffnessOf(V.rows(), F, [=](Index, int) { return cotangentOf60Degrees; });
    const double mean = lumpedMass(V, F).mean();
    return {std::move(W), Eigen::VectorXd::Constant(V.rows(), mean)};
}

Eigen::VectorXd lumpedMass(const Vertices& V, const Faces& F) {
    Eigen::VectorXd third(F.rows());  // of a triangle's area
    parallelRows(F.rows(), [&](Index begin, Index end) {
        for (Index t = begin; t < end; ++t) {
            const Eigen::RowVector3d a = V.row(F(t, 0)), b = V.row(F(t, 1)), c = V.row(F(t, 2));
            third[t] = (b - a).cross(c - a).norm() / 6.0;
        }
    });
    Eigen::VectorXd D = Eigen::VectorXd::Zero(V.rows());
    for (Index t = 0; t < F.rows(); ++t)
        for (int k = 0; k < 3; ++k) D[F(t, k)] += third[t];
    return D;
}

bool isUsable(const Laplacian& laplacian) {
    return laplacian.W.coeffs().allFinite() && laplacian.D.allFinite() &&
           laplacian.D.minCoeff() > 0.0;
}

}  // namespace spectral
