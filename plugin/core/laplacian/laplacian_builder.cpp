#include "core/laplacian/laplacian_builder.h"

#include "core/mesh/mesh.h"

namespace spectral {

LaplacianBuilder::LaplacianBuilder(const Surface& surface, LaplacianKind kind, BasisUpdate update,
                                   double conformalShare)
    : surface_(surface), update_(update), conformalShare_(conformalShare) {
    if (kind == LaplacianKind::IntrinsicDelaunay) intrinsic_.emplace(surface.X, surface.F);
    current_ = {stiffness(surface.X), mass(surface.X)};
    inputMass_ = current_.D;
    if (update == BasisUpdate::Full) inputStiffness_ = current_.W;
}

const Laplacian& LaplacianBuilder::input() {
    if (update_ == BasisUpdate::Full) current_.W = inputStiffness_;
    current_.D = inputMass_;
    return current_;
}

const Laplacian& LaplacianBuilder::operator()(const Vertices& X) {
    if (update_ == BasisUpdate::None) return input();
    if (update_ == BasisUpdate::Full) {
        current_.W = stiffness(X);
        if (conformalShare_ > 0.0)
            current_.W =
                ((1.0 - conformalShare_) * current_.W + conformalShare_ * inputStiffness_).eval();
    }
    current_.D = mass(X);
    return current_;
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
