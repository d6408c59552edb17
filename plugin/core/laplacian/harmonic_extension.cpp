#include "core/laplacian/harmonic_extension.h"

#include <algorithm>

namespace spectral {

namespace {

/// W X from differences along edges: no cancellation where X varies little.
Eigen::MatrixXd applied(const SparseMatrix& W, const Eigen::MatrixXd& X) {
    Eigen::MatrixXd WX = Eigen::MatrixXd::Zero(X.rows(), X.cols());
    for (Index j = 0; j < W.cols(); ++j)
        for (SparseMatrix::InnerIterator entry(W, j); entry; ++entry)
            WX.row(j) += entry.value() * (X.row(entry.row()) - X.row(j));
    return WX;
}

}  // namespace

HarmonicExtension::Remainder HarmonicExtension::remainder(const Laplacian& surface,
                                                          const Laplacian& inside,
                                                          const Eigen::MatrixXd& X) {
    // W_II is singular on components without fixed vertices: adding masses there, and only there,
    // makes it definite. On these components H is the mean, not the solution.
    const Eigen::VectorXd D = (interior_.components().label->array() < 0).select(0.0, inside.D);
    ldlt_.factorizeDefinite(inside.W, D, 4.0 * kPi / surface.D.sum());
    Eigen::MatrixXd centred = X;
    surface.constants.remove(surface.D, centred);

    // X - H = W_II^-1 (W X)_I: no cancellation where X is nearly harmonic. A second solve, for the
    // residual of the first, matters for needle triangles.
    Remainder remainder{Eigen::MatrixXd::Zero(interior_.size(), X.cols())};
    for (int pass = 0; pass < 2; ++pass)
        remainder.U += ldlt_.solve(
            interior_.restricted(applied(surface.W, centred - interior_.extended(remainder.U))));
    const Eigen::MatrixXd moving = interior_.restricted(centred);
    for (Index i = 0; i < moving.rows(); ++i)
        if (interior_.components().label[i] >= 0) remainder.U.row(i) = moving.row(i);

    const Eigen::VectorXd sqrtD = surface.D.cwiseSqrt();
    const double norm = (interior_.restricted(sqrtD).col(0).asDiagonal() * remainder.U).norm();
    remainder.relativeSize =
        std::max(norm / (sqrtD.asDiagonal() * centred).norm(),
                 remainder.U.cwiseAbs().maxCoeff() / centred.cwiseAbs().maxCoeff());
    return remainder;
}

}  // namespace spectral
