#pragma once

#include <optional>

#include "core/laplacian/intrinsic_delaunay.h"
#include "core/laplacian/laplacian.h"
#include "core/mesh/surface.h"

namespace spectral {

enum class LaplacianKind {
    IntrinsicDelaunay,  ///< Any triangles, non-negative weights (intrinsic_delaunay.h).
    Cotangent,          ///< The paper's plain cotangents; every triangle needs a positive area.
    Uniform             ///< For vertex noise: depends only on the connectivity and the area.
};

/// Rejects a mesh that has no Laplacian of this kind.
/// @throws InvalidMesh  see mesh_check.h.
void checkMesh(const Vertices& V, const Faces& F, LaplacianKind kind);

/// What a step recomputes from the current shape.
enum class BasisUpdate {
    Full,       ///< W and D: the paper's scheme.
    Conformal,  ///< D only; W remains that of the input (Kazhdan, Solomon, Ben-Chen 2012).
    None        ///< Neither: one basis for all steps (Vallet and Levy 2008).
};

/// Holds the Laplacian of the current shape as a filter proceeds. It returns no copies, as W takes
/// a gigabyte for ten million vertices.
class LaplacianBuilder {
  public:
    /// Starts with the input.
    /// @param surface  kept by reference; its X is the input shape X_0.
    /// @param conformalShare  for BasisUpdate::Full, from 0 (the paper's scheme) to 1 (conformal):
    ///                        W = (1 - share) W(X) + share W(X_0). If a part has shrunk to a line,
    ///                        its mass vanishes but this share of W does not, and contracts the
    ///                        line.
    /// @param edges  of surface.F, if they are known.
    LaplacianBuilder(const Surface& surface, Components components, LaplacianKind kind,
                     BasisUpdate update, double conformalShare = 0.0,
                     std::optional<SidesByEdge> edges = {});

    const Laplacian& current() const { return current_; }

    /// Updates the Laplacian for the shape X (n x 3), according to BasisUpdate.
    /// @throws SolverFailure  when the shape has vanished.
    void update(const Vertices& X);

    /// Returns to the Laplacian of the input.
    void reset();

    /// Multiplies D of the input and of all later shapes, by all factors so far (thin_parts.h);
    /// returns to the input.
    /// @param factors  n, > 0.
    void scaleMass(Eigen::VectorXd factors);

    /// Multiplies D where slivers alone cause eigenvalues of the input above `largest`: D_ii
    /// becomes 2 W_ii / largest, but at most a quarter of the mean of D around the vertex. Such a
    /// vertex follows its neighbours at once with either mass; where all triangles are needles, as
    /// on a cylinder by CAD, it would not, and D remains. It is a factor, not a lower bound, so
    /// that the mass of what collapses does so, too.
    /// @param largest  > 0, far above the eigenvalues of all details of the filter.
    void boundEigenvalues(double largest);

    /// Area of the current shape: the sum of D before its lower bound and factors are applied.
    double area() const { return area_; }

    /// D of the input, without factors.
    const Eigen::VectorXd& inputMass() const { return inputMass_; }

    /// D of the shape X, > 0, without factors.
    Eigen::VectorXd mass(const Vertices& X) const;

    const Faces& faces() const { return surface_.F; }

  private:
    void setMass(Eigen::VectorXd D, double area);
    SparseMatrix stiffness(const Vertices& X) const;
    Eigen::VectorXd boundedMass(const Eigen::VectorXd& D) const;

    const Surface& surface_;
    Components components_;
    LaplacianKind kind_;
    BasisUpdate update_;
    double conformalShare_;
    std::optional<IntrinsicDelaunay> intrinsic_;
    SparseMatrix inputStiffness_;  // empty if W is never updated
    Eigen::VectorXd inputMass_;
    Eigen::VectorXd massFactors_;  // empty: 1
    Laplacian current_;
    double area_ = 0.0;
};

/// The Laplacian of an unfiltered mesh, for `analysis`.
struct MeshLaplacian {
    Surface surface;  ///< Its vertices are the rows of W and D.
    Components components;
    Laplacian laplacian;
};

/// @param V  n x 3 positions, finite; unreferenced vertices allowed.
/// @param F  m x 3 vertex indices, m >= 1; any topology.
/// @throws InvalidMesh  as checkMesh.
/// @throws SolverFailure  when a cotangent or a mass is not finite.
MeshLaplacian meshLaplacian(const Vertices& V, const Faces& F, LaplacianKind kind);

/// That of a surface.
/// @throws SolverFailure  when a cotangent or a mass is not finite.
MeshLaplacian meshLaplacian(Surface surface, LaplacianKind kind);

}  // namespace spectral
