#pragma once

#include "core/mesh/surface.h"

namespace spectral {

/// The constant modes of a Laplacian: its null space, one constant function per component. Vertices
/// with label -1 have none: their component has a fixed boundary (interior.h).
///
/// A filter changes shape, not place: the gain of these modes is 1 whatever F(0) is. They are
/// removed from a signal before F is applied and restored afterwards, both exactly; a computed
/// eigenvalue of 1e-12 instead of 0 would move a mesh that lies far from the origin.
class ConstantModes {
  public:
    ConstantModes() = default;

    /// @param D  n lumped masses, > 0.
    ConstantModes(const Components& components, const Eigen::VectorXd& D);

    int count() const { return static_cast<int>(mass_.size()); }

    const Eigen::VectorXi& label() const { return *label_; }  ///< n, -1 at vertices without a mode.
    const Eigen::VectorXd& masses() const { return mass_; }   ///< Sum of D over each component.

    /// D-weighted mean of every column of X (n x c) on every component: count x c.
    /// @param D  the masses, here as well.
    Eigen::MatrixXd means(const Eigen::VectorXd& D,
                          const Eigen::Ref<const Eigen::MatrixXd>& X) const;

    /// Adds to every row of X (n x c) the means (count x c) of its component.
    void add(const Eigen::MatrixXd& means, Eigen::Ref<Eigen::MatrixXd> X) const;

    /// D-orthogonal projection of X onto the complement of the constants, in place.
    void remove(const Eigen::VectorXd& D, Eigen::Ref<Eigen::MatrixXd> X) const {
        add(-means(D, X), X);
    }

    /// The D-orthonormal modes, n x count: 1/sqrt(mass) on one component, 0 elsewhere.
    Eigen::MatrixXd orthonormal() const;

  private:
    Labels label_;
    Eigen::VectorXd mass_;
    bool isWhole_ = false;  // a single mode on all vertices, the usual case
};

}  // namespace spectral
