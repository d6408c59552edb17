#pragma once

#include <vector>

#include "core/laplacian/laplacian.h"
#include "core/mesh/components.h"
#include "core/mesh/mesh.h"

namespace spectral {

/// What happens at the boundary of a surface.
enum class Boundary {
    Free,  ///< Natural (Neumann) conditions: it moves as the rest does.
    Fixed  ///< Dirichlet conditions: its vertices stay where they are, harmonics are zero there.
};

/// The part of a surface that can move: all of it, or all but a fixed boundary.
///
/// On the interior the eigenproblem is W_II phi = lambda D_II phi, phi = 0 on the boundary; all
/// that works on a Laplacian works on this one.
class Interior {
  public:
    /// @param F           m x 3 triangles of the surface.
    /// @param components  of the surface, n vertices.
    Interior(const Faces& F, Components components, Boundary boundary);

    Index size() const { return static_cast<Index>(vertex_.size()); }  ///< Vertices that can move.
    Index fixedVertices() const { return surfaceComponents_.label.size() - size(); }
    bool isWhole() const { return fixedVertices() == 0; }

    /// Components without any fixed vertex, which have a constant mode, with labels for the rows of
    /// the interior; the other vertices have the label -1.
    const Components& components() const { return components_; }

    /// All components, with labels for the rows of the surface.
    const Components& surfaceComponents() const { return surfaceComponents_; }

    /// W_II and D_II.
    Laplacian restricted(const Laplacian& surface) const;

    /// The rows of the interior of a signal X (n x c).
    Eigen::MatrixXd restricted(const Eigen::MatrixXd& X) const;

    /// Values of the interior (rows of `values`) on the surface, 0 at fixed vertices: n x c.
    Eigen::MatrixXd extended(Eigen::MatrixXd values) const;

  private:
    Components surfaceComponents_;
    std::vector<Index> vertex_;  // of the surface for each row of the interior, ascending
    Components components_;
};

}  // namespace spectral
