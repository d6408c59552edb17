#include "core/laplacian/laplacian.h"

#include <Eigen/Geometry>
#include <vector>

#include "core/support/threads.h"

namespace spectral {

Laplacian cotangentLaplacian(const Vertices& V, const Faces& F) {
    const Index n = V.rows();
    Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(n);
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(static_cast<std::size_t>(6 * F.rows() + n));

    for (Index t = 0; t < F.rows(); ++t) {
        Eigen::RowVector3d corner[3];
        for (int c = 0; c < 3; ++c) corner[c] = V.row(F(t, c));
        const double twiceArea = (corner[1] - corner[0]).cross(corner[2] - corner[0]).norm();
        for (int c = 0; c < 3; ++c) {
            // The angle at corner c lies opposite to the edge (i, j).
            const int i = F(t, (c + 1) % 3), j = F(t, (c + 2) % 3);
            const double cotangent =
                (corner[(c + 1) % 3] - corner[c]).dot(corner[(c + 2) % 3] - corner[c]) / twiceArea;
            const double w = 0.5 * cotangent;
            entries.emplace_back(i, j, -w);
            entries.emplace_back(j, i, -w);
            diagonal[i] += w;
            diagonal[j] += w;
        }
    }
    for (int i = 0; i < n; ++i) entries.emplace_back(i, i, diagonal[i]);

    SparseMatrix W(n, n);
    W.setFromTriplets(entries.begin(), entries.end());
    return {std::move(W), lumpedMass(V, F)};
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
