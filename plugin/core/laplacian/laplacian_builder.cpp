#include "core/laplacian/laplacian_builder.h"

#include <algorithm>
#include <utility>

#include "core/mesh/measures.h"
#include "core/mesh/mesh_check.h"
#include "core/support/errors.h"
#include "core/support/threads.h"

namespace spectral {

void checkMesh(const Vertices& V, const Faces& F, LaplacianKind kind) {
    checkMesh(V, F);
    if (kind == LaplacianKind::Cotangent) checkAreas(V, F);
}

LaplacianBuilder::LaplacianBuilder(const Surface& surface, Components components,
                                   LaplacianKind kind, BasisUpdate update, double conformalShare,
                                   std::optional<SidesByEdge> edges)
    : surface_(surface),
      components_(std::move(components)),
      kind_(kind),
      update_(update),
      conformalShare_(conformalShare) {
    if (kind == LaplacianKind::IntrinsicDelaunay) {
        if (!edges) edges.emplace(surface.F);
        intrinsic_.emplace(surface.X, surface.F, *edges);
        edges.reset();  // memory that lengths and cotangents need
    }
    // Unless W is updated, its topology ends with it.
    current_.W = intrinsic_ && update != BasisUpdate::Full
                     ? std::move(*intrinsic_).stiffness(surface.X)
                     : stiffness(surface.X);
    if (update != BasisUpdate::Full) intrinsic_.reset();
    inputMass_ = mass(surface.X);
    setMass(inputMass_, inputMass_.sum());
    if (update == BasisUpdate::Full) inputStiffness_ = current_.W;
}

void LaplacianBuilder::setMass(Eigen::VectorXd D, double area) {
    current_.D = std::move(D);
    if (massFactors_.size() > 0) current_.D.array() *= massFactors_.array();
    current_.constants = ConstantModes(components_, current_.D);
    area_ = area;
}

void LaplacianBuilder::reset() {
    if (update_ == BasisUpdate::Full) current_.W = inputStiffness_;
    setMass(inputMass_, inputMass_.sum());
}

void LaplacianBuilder::scaleMass(Eigen::VectorXd factors) {
    if (massFactors_.size() > 0) factors.array() *= massFactors_.array();
    massFactors_ = std::move(factors);
    reset();
}

void LaplacianBuilder::boundEigenvalues(double largest) {
    constexpr double kShare = 0.25;  // of the mean: too little to slow down a region of slivers
    const SparseMatrix& W = current_.W;
    Eigen::VectorXd factors(W.rows());
    parallelRows(W.rows(), [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) {
            double around = 0.0, diagonal = 0.0, count = 0.0;
            for (SparseMatrix::InnerIterator entry(W, i); entry; ++entry) {
                if (entry.row() == i) diagonal = entry.value();
                around += inputMass_[entry.row()];
                count += 1.0;
            }
            const double least = std::min(2.0 * diagonal / largest, kShare * around / count);
            factors[i] = least > inputMass_[i] ? least / inputMass_[i] : 1.0;
        }
    });
    if ((factors.array() > 1.0).any()) scaleMass(std::move(factors));
}

void LaplacianBuilder::update(const Vertices& X) {
    if (update_ == BasisUpdate::None) return;
    const Eigen::VectorXd D = lumpedMass(X, surface_.F);
    setMass(boundedMass(D), D.sum());
    // Relative to the input. A surface that has shrunk to a line has no area, but still has edges.
    constexpr double kVanished = 1e-10;
    if (area_ <= kVanished * kVanished * inputMass_.sum() &&
        meanEdgeLength(X, surface_.F) <= kVanished * meanEdgeLength(surface_.X, surface_.F))
        throw SolverFailure(ErrorCode::ShrinksToNothing, "the whole surface shrinks to nothing");
    if (update_ == BasisUpdate::Full) {
        current_.W = stiffness(X);
        if (conformalShare_ > 0.0)
            current_.W =
                ((1.0 - conformalShare_) * current_.W + conformalShare_ * inputStiffness_).eval();
    }
}

SparseMatrix LaplacianBuilder::stiffness(const Vertices& X) const {
    if (kind_ == LaplacianKind::Uniform) return uniformStiffness(X.rows(), surface_.F);
    return intrinsic_ ? intrinsic_->stiffness(X) : cotangentStiffness(X, surface_.F);
}

/// Uses the triangles of the mesh for every kind: intrinsic areas jump when an edge flips, while
/// second-order steps need D to depend continuously on the shape.
Eigen::VectorXd LaplacianBuilder::mass(const Vertices& X) const {
    return boundedMass(lumpedMass(X, surface_.F));
}

Eigen::VectorXd LaplacianBuilder::boundedMass(const Eigen::VectorXd& D) const {
    // Smallest mass, relative to the mean, in parts that have shrunk to a line or a point. The
    // D-inner product needs it to be positive; its value does not matter, as such a vertex is at
    // the harmonic mean of its neighbours.
    constexpr double kFloor = 1e-12;
    if (kind_ == LaplacianKind::Uniform) return Eigen::VectorXd::Constant(D.size(), D.mean());
    return D.cwiseMax(kFloor * D.mean());
}

MeshLaplacian meshLaplacian(const Vertices& V, const Faces& F, LaplacianKind kind) {
    checkMesh(V, F, kind);
    return meshLaplacian(joinedSurface(V, F), kind);
}

MeshLaplacian meshLaplacian(Surface surface, LaplacianKind kind) {
    Components components = connectedComponents(surface.F, surface.X.rows());
    Laplacian laplacian = LaplacianBuilder(surface, components, kind, BasisUpdate::None).current();
    requireUsable(laplacian);
    return {std::move(surface), std::move(components), std::move(laplacian)};
}

}  // namespace spectral
