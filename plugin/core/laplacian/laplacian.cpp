#include "core/laplacian/laplacian.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/support/errors.h"
#include "core/support/threads.h"

namespace spectral {

namespace {

/// W with weights (cot a_ij + cot b_ij)/2.
/// @param cotangentsOf  maps t to the cotangents of the angles of triangle t.
template <class Cotangents>
SparseMatrix stiffnessOf(Index n, const Faces& F, const Cotangents& cotangentsOf) {
    Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(n);
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(static_cast<std::size_t>(6 * F.rows() + n));
    for (Index t = 0; t < F.rows(); ++t) {
        const Eigen::Vector3d cotangents = cotangentsOf(t);
        for (int c = 0; c < 3; ++c) {
            // The angle at corner c is opposite the edge (i, j).
            const int i = F(t, (c + 1) % 3), j = F(t, (c + 2) % 3);
            const double w = 0.5 * cotangents[c];
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

SparseMatrix cotangentStiffness(const Vertices& V, const Faces& F) {
    const auto cotangents = [&](Index t) {
        Eigen::RowVector3d corner[3];
        for (int c = 0; c < 3; ++c) corner[c] = V.row(F(t, c));
        const double twiceArea = (corner[1] - corner[0]).cross(corner[2] - corner[0]).norm();
        Eigen::Vector3d result;
        for (int c = 0; c < 3; ++c)
            result[c] =
                (corner[(c + 1) % 3] - corner[c]).dot(corner[(c + 2) % 3] - corner[c]) / twiceArea;
        return result;
    };
    return stiffnessOf(V.rows(), F, cotangents);  // Kovnatsky et al. 2012, Eq. 4
}

SparseMatrix uniformStiffness(Index n, const Faces& F) {
    const Eigen::Vector3d equilateral = Eigen::Vector3d::Constant(1.0 / std::sqrt(3.0));
    return stiffnessOf(n, F, [&](Index) { return equilateral; });
}

Eigen::VectorXd lumpedMass(const Vertices& V, const Faces& F) {
    constexpr Index kChunk = 32 * kRowsPerTask;  // its thirds stay in the cache
    std::vector<double> third(static_cast<std::size_t>(std::min(kChunk, F.rows())));
    Eigen::VectorXd D = Eigen::VectorXd::Zero(V.rows());  // Kovnatsky et al. 2012, Eq. 4
    for (Index first = 0; first < F.rows(); first += kChunk) {
        const Index count = std::min(kChunk, F.rows() - first);
        parallelRows(count, [&](Index begin, Index end) {
            for (Index k = begin; k < end; ++k) {
                const Index t = first + k;
                const Eigen::RowVector3d a = V.row(F(t, 0)), b = V.row(F(t, 1)), c = V.row(F(t, 2));
                third[k] = (b - a).cross(c - a).norm() / 6.0;  // of the triangle's area
            }
        });
        for (Index k = 0; k < count; ++k)
            for (int c = 0; c < 3; ++c) D[F(first + k, c)] += third[k];
    }
    return D;
}

bool isUsable(const Laplacian& laplacian) {
    const double* values = laplacian.W.valuePtr();
    const Index unusable =
        parallelSum(laplacian.W.nonZeros(), Index{0}, [&](Index begin, Index end) {
            return end - begin - std::count_if(values + begin, values + end, [](double w) {
                       return std::isfinite(w);
                   });
        });
    return unusable == 0 && laplacian.D.allFinite() && laplacian.D.minCoeff() > 0.0;
}

void requireUsable(const Laplacian& laplacian) {
    if (!isUsable(laplacian))
        throw SolverFailure(ErrorCode::DegenerateTriangles,
                            "some triangles have almost no area or have collapsed: a cotangent "
                            "or a mass is not finite");
}

}  // namespace spectral
