#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/filter/step_evaluator.h"
#include "core/laplacian/laplacian_builder.h"
#include "core/mesh/mesh.h"
#include "core/support/progress.h"
#include "core/support/types.h"

namespace spectral {

struct ThinParts {
    Eigen::VectorXd factors;  ///< n factors of D >= 1; empty if nothing needs to be kept.
    double largest = 1.0;     ///< The largest factor, even if there are none.
};

/// What decides about the thin parts of a tile of a larger surface. Where it is cut, it shrinks
/// like a thin part.
struct ThinPartsOfTile {
    std::vector<bool> inner;  ///< n, the vertices of the surface that count for ThinParts::largest.
    bool areKept = false;     ///< Whether the whole surface has parts to be kept.
};

/// Logarithms of the areas around each vertex and its neighbours: as much as noise needs, as little
/// as narrow rims allow.
/// @param W  stiffness matrix; its pattern gives the neighbours.
Eigen::ArrayXd logAreasAround(const SparseMatrix& W, const Faces& F, const Vertices& X);

/// Factors of D that keep the parts of a shape that a low-pass would shrink to lines or points.
///
/// A low-pass of feature size L takes away a part whose girth g is below L: its area shrinks to
/// q = F(2 pi / g) of what it was. Where q would be below 0.75, vertices get a feature size L_i < L
/// of their own, at which 0.75 is left. Lengths there count L / L_i times, so D_ii is multiplied by
///     m_i = (L / L_i)^2 = log q / log 0.75,
/// which is exact for a Gaussian, where log F is proportional to lambda and thus to 1 / m_i. W does
/// not change: it is conformally invariant. W phi = lambda m D phi is the Laplacian of the same
/// surface with another metric, so there is no seam between parts.
///
/// q is measured on two powers of the filter, over the triangles around a vertex and its
/// neighbours. F^(1/4) has removed most of the noise, whose area is none of the part's; where it
/// takes more area than noise has, it gives q itself.
///
/// @param W      stiffness matrix of X; its pattern gives the neighbours.
/// @param X      n x 3, the shape.
/// @param weak   F^(1/4)(sqrt(A)) X.
/// @param whole  F(sqrt(A)) X.
/// @param tile   null for a whole surface.
/// @return       no factors if no part loses half of its area, or the whole surface keeps none.
ThinParts thinPartFactors(const SparseMatrix& W, const Faces& F, const Vertices& X,
                          const Vertices& weak, const Vertices& whole,
                          const ThinPartsOfTile* tile = nullptr);

/// Keeps the thin parts of X in all evaluations that follow: multiplies D by their factors.
/// @param evaluate  of a low-pass.
/// @return  the largest factor (ThinParts).
double keepThinParts(LaplacianBuilder& laplacians, StepEvaluator& evaluate, const Vertices& X,
                     const ThinPartsOfTile* tile, const Progress& progress);

}  // namespace spectral
