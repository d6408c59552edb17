#pragma once

#include <optional>

#include "core/laplacian/intrinsic_delaunay.h"
#include "core/laplacian/laplacian.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"

namespace spectral {

enum class LaplacianKind {
    IntrinsicDelaunay,  ///< Robust: any triangles, all weights non-negative (intrinsic_delaunay.h).
    Cotangent           ///< The paper's: plain cotangents, every triangle needs an area.
};

/// What a step takes from the current shape.
enum class BasisUpdate {
    Full,       ///< W and D: the paper's scheme.
    Conformal,  ///< D only, W stays that of the input (Kazhdan, Solomon, Ben-Chen 2012).
    None        ///< Neither: one basis for all steps (Vallet and Levy 2008).
};

/// Makes the Laplacians of the shapes that a surface takes on in the course of a filter.
class LaplacianBuilder {
  public:
    /// @param surface  kept by reference; its X is the input's shape.
    /// @param conformalShare  for BasisUpdate::Full: part of W, 0 to 1, that stays the input's,
    ///                        W = (1 - share) W(X) + share W(X_0); 0 is the paper's scheme, 1 the
    ///                        conformal update. Where a part has pinched to a line, the mass of the
    ///                        line vanishes but this share of W does not, and draws the line in.
    LaplacianBuilder(const Surface& surface, LaplacianKind kind, BasisUpdate update,
                     double conformalShare = 0.0);

    /// The Laplacian of the input; until the next call of this or of the next function.
    const Laplacian& input();

    /// The Laplacian of the shape X (n x 3), as far as the update takes it from there; likewise.
    const Laplacian& operator()(const Vertices& X);

    /// The masses of the input.
    const Eigen::VectorXd& inputMass() const { return inputMass_; }

    /// Its D alone: a third of the area of the triangles at every vertex, > 0.
    Eigen::VectorXd mass(const Vertices& X) const;

  private:
    SparseMatrix stiffness(const Vertices& X) const;

    const Surface& surface_;
    BasisUpdate update_;
    double conformalShare_;
    std::optional<IntrinsicDelaunay> intrinsic_;
    SparseMatrix inputStiffness_;  // empty where W stays that of the input
    Eigen::VectorXd inputMass_;
    Laplacian current_;
};

}  // namespace spectral
