#include "laplacian_builder.h"

namespace spectral {

LaplacianBuilder::LaplacianBuilder(const Surface& surface, LaplacianKind kind, BasisUpdate update,
                                   double conformalShare)
    : surface_(surface), update_(update), conformalShare_(conformalShare) {
    if (kind == LaplacianKind::IntrinsicDelaunay) intrinsic_.emplace(surface.X, surface.F);
    input_ = {stiffness(surface.X), mass(surface.X)};
}

Laplacian LaplacianBuilder::operator()(const Vertices& X) const {
    switch (update_) {
        case BasisUpdate::Full:
            if (conformalShare_ == 0.0) return {stiffness(X), mass(X)};
            return {(1.0 - conformalShare_) * stiffness(X) + conformalShare_ * input_.W, mass(X)};
        case BasisUpdate::Conformal: return {input_.W, mass(X)};
        case BasisUpdate::None: break;
    }
    return input_;
}

SparseMatrix LaplacianBuilder::stiffness(const Vertices& X) const {
    return intrinsic_ ? intrinsic_->stiffness(X) : cotangentLaplacian(X, surface_.F).W;
}

/// The areas of the mesh's own triangles, for both kinds: those of the intrinsic ones jump where an
/// edge flips, and steps of second order need a D that follows the shape continuously.
Eigen::VectorXd LaplacianBuilder::mass(const Vertices& X) const {
    // Thin parts shrink to a line or a point. A mass this far below the others no longer moves
    // anything (its vertex is the harmonic mean of its neighbours), but the D-inner product needs
    // it positive.
    constexpr double kFloor = 1e-12;
    const Eigen::VectorXd D = lumpedMass(X, surface_.F);
    return D.cwiseMax(kFloor * D.mean());
}

}  // namespace spectral
