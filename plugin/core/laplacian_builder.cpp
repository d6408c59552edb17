#include "laplacian_builder.h"

namespace spectral {

LaplacianBuilder::LaplacianBuilder(const Surface& surface, LaplacianKind kind, BasisUpdate update)
    : surface_(surface), update_(update), inputMass_(lumpedMass(surface.X, surface.F)) {
    if (kind == LaplacianKind::IntrinsicDelaunay) intrinsic_.emplace(surface.X, surface.F);
    input_ = ofShape(surface.X);
}

Laplacian LaplacianBuilder::operator()(const Vertices& X) const {
    switch (update_) {
        case BasisUpdate::Full: return ofShape(X);
        case BasisUpdate::Conformal: return conformal(X);
        case BasisUpdate::None: break;
    }
    return input_;
}

Laplacian LaplacianBuilder::ofShape(const Vertices& X) const {
    return intrinsic_ ? intrinsic_->laplacian(X) : cotangentLaplacian(X, surface_.F);
}

/// The input's masses, times the factor by which the area round every vertex has changed.
Laplacian LaplacianBuilder::conformal(const Vertices& X) const {
    // Thin parts shrink to a line or a point. A mass this far below the others no longer moves
    // anything (its vertex is the harmonic mean of its neighbours), but the D-inner product needs
    // it positive.
    constexpr double kFloor = 1e-12;
    const Eigen::VectorXd mass = lumpedMass(X, surface_.F);
    Eigen::VectorXd D = input_.D;
    for (Index i = 0; i < D.size(); ++i)
        if (inputMass_[i] > 0.0) D[i] *= mass[i] / inputMass_[i];
    return {input_.W, D.cwiseMax(kFloor * D.mean())};
}

}  // namespace spectral
