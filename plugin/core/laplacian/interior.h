#pragma once

#include <utility>
#include <vector>

#include "core/laplacian/laplacian.h"
#include "core/mesh/surface.h"

namespace spectral {

/// Boundary conditions of a surface.
enum class Boundary {
    Free,  ///< Natural (Neumann) conditions: the boundary moves like the rest.
    Fixed  ///< Dirichlet conditions: boundary vertices do not move, harmonics vanish there.
};

/// Whether each vertex lies on the boundary, i.e. on an edge of exactly one triangle.
///
/// @param F  m x 3 indices in [0, vertexCount).
std::vector<bool> boundaryVertices(const Faces& F, Index vertexCount);

/// Whether each vertex is fixed: the boundary vertices for Boundary::Fixed, else none.
std::vector<bool> fixedVerticesOf(const Faces& F, Index vertexCount, Boundary boundary);

/// The vertices of a surface that can move: all, or all except a fixed boundary.
///
/// The eigenproblem of the interior is W_II phi = lambda D_II phi, phi = 0 on the boundary.
class Interior {
  public:
    /// @param F           m x 3 triangles of the surface.
    /// @param components  connected components of the surface, n vertices.
    Interior(const Faces& F, Components components, Boundary boundary);

    /// @param fixed  n, whether each vertex is fixed.
    Interior(Components components, const std::vector<bool>& fixed);

    Index size() const { return size_; }
    Index fixedVertices() const { return surfaceComponents_.label->size() - size_; }
    bool isWhole() const { return fixedVertices() == 0; }

    /// Labels of the interior vertices on components without fixed vertices, which have a constant
    /// mode; -1 on the other components.
    const Components& components() const { return components_; }

    /// Labels of all vertices of the surface.
    const Components& surfaceComponents() const { return surfaceComponents_; }

    /// W_II and D_II, with the constant modes of the components without fixed vertices.
    Laplacian restricted(const Laplacian& surface) const;

    /// The rows of a signal X (n x c) that belong to interior vertices.
    Eigen::MatrixXd restricted(const Eigen::MatrixXd& X) const;

    /// Extends values at interior vertices to the surface by zero: n x c.
    Eigen::MatrixXd extended(Eigen::MatrixXd values) const {
        return extendedByZero(std::move(values), vertex_, surfaceComponents_.label->size());
    }

  private:
    Components surfaceComponents_;
    Index size_ = 0;
    std::vector<Index> vertex_;  // surface vertex of each row of the interior, unless it is whole
    Components components_;
};

}  // namespace spectral
