#pragma once

#include <Eigen/Core>

#include "core/mesh/components.h"
#include "core/mesh/mesh.h"

namespace spectral {

/// The constant modes of a Laplacian: its null space, one constant function for each component.
/// Vertices of label -1 have none: they hang on a fixed boundary (boundary.h).
///
/// A filter changes shape, not place, so the gain of these modes is 1 whatever F(0) is. They are
/// taken out of a signal exactly before F is applied and put back afterwards; no eigenvalue of
/// 1e-12 in the place of 0 can then drag a mesh that lies far from the origin.
class ConstantModes {
  public:
    /// @param D  n lumped masses, > 0.
    ConstantModes(const Components& components, const Eigen::VectorXd& D);

    int count() const { return static_cast<int>(mass_.size()); }

    const Eigen::VectorXi& label() const { return label_; }  ///< n; -1 for those without a mode.
    const Eigen::VectorXd& masses() const { return mass_; }  ///< Of the components.

    /// D-weighted mean of every column of X (n x c) on every component: count x c.
    Eigen::MatrixXd means(const Eigen::Ref<const Eigen::MatrixXd>& X) const;

    /// Adds row label(i) of `means` (count x c) to row i of X, nothing where the label is -1.
    void add(const Eigen::MatrixXd& means, Eigen::Ref<Eigen::MatrixXd> X) const;

    /// D-orthogonal projection of X onto the complement of the constants, in place.
    void remove(Eigen::Ref<Eigen::MatrixXd> X) const { add(-means(X), X); }

    /// The modes themselves, n x count, D-orthonormal: 1/sqrt(mass) on one component, 0 elsewhere.
    Eigen::MatrixXd orthonormal() const;

  private:
    Eigen::VectorXi label_;
    Eigen::VectorXd D_;
    Eigen::VectorXd mass_;
    bool isWhole_ = false;  // one mode, on all vertices: what most meshes have
};

}  // namespace spectral
