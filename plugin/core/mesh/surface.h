#pragma once

#include <Eigen/Core>
#include <memory>
#include <utility>
#include <vector>

#include "core/mesh/mesh.h"
#include "core/mesh/seams.h"

namespace spectral {

/// The part of a mesh that a Laplacian is defined on.
struct Surface {
    /// A vertex of the mesh that is joined to another (seams.h).
    struct Copy {
        Index vertex;  ///< Row in the mesh.
        Index row;     ///< Row of X.
    };

    Vertices X;  ///< n x 3, centred by bounding box: no digits are lost far from the origin.
    Faces F;     ///< m x 3, indices into X; the corners of a triangle are distinct.
    std::vector<Index> vertex;       ///< Row in the mesh of each row of X, ascending.
    std::vector<Copy> copies{};      ///< Vertices of the mesh that are joined to those, ascending.
    std::vector<Hanging> hanging{};  ///< Rows of X on edges of coarser triangles, which are split
                                     ///< there (seams.h).
    int nearlyCopies = 0;            ///< Vertices that would be copies but for round-off.
    int flatComponents = 0;  ///< Components without area, such as a triangle of three equal points,
                             ///< which are left out; X and F do not have them.
};

/// The triangles with three distinct corners, and their vertices, renumbered. Unreferenced vertices
/// are dropped.
Surface surfaceOf(const VerticesView& V, const FacesView& F);

/// The same, with the vertices along seams joined: each row of X is the first such vertex of the
/// mesh, the others are its copies. Components without area are left out, unless all are.
Surface joinedSurface(const VerticesView& V, const FacesView& F);

/// The same with the edges of its triangles, which seams are found by: their sorting takes longer
/// than most passes over a mesh.
struct SurfaceWithEdges {
    Surface surface;
    SidesByEdge edges;  ///< Of surface.F.
};
SurfaceWithEdges joinedSurfaceWithEdges(const VerticesView& V, const FacesView& F);

/// Restricts values at the vertices of a mesh to its surface; at a seam, to the mean of the copies.
/// @param values  one row per vertex of the mesh.
Eigen::MatrixXd restricted(const Eigen::MatrixXd& values, const Surface& surface);

/// Extends values on a surface to the n vertices of its mesh, by zero off the surface.
Eigen::MatrixXd extended(Eigen::MatrixXd values, const Surface& surface, Index n);

/// Adds a change on a surface to the values of its mesh. At a seam all copies get the same value; a
/// value whose change is zero is left bit-for-bit unchanged, including the sign of a zero.
Eigen::MatrixXd changed(const Eigen::MatrixXd& values, const Surface& surface,
                        const Eigen::MatrixXd& change);

/// Lets the hanging vertices that are fixed stay, whatever their edges do.
/// @param isFixed  n, of the rows of surface.X.
void keepFixed(const std::vector<bool>& isFixed, Surface& surface);

/// Lets hanging vertices follow their edges: the mean of the ends' displacements, by the share.
/// @param displacement  n x 3, of the rows of X.
void followEdges(const Surface& surface, Vertices& displacement);

/// `changed` for positions; hanging vertices are on their edges to the last bit, if these have
/// moved.
Vertices moved(const Vertices& V, const Surface& surface, const Vertices& displacement);

/// Extends values at some of n vertices by zero: row i of `values` (m x c) becomes row vertex[i] of
/// the result (n x c).
Eigen::MatrixXd extendedByZero(Eigen::MatrixXd values, const std::vector<Index>& vertex, Index n);

/// Numbers of components and special vertices of a surface.
struct SurfaceCounts {
    int components = 0;            ///< Connected components.
    int unreferencedVertices = 0;  ///< Vertices in no triangle; they do not change.
    int joinedVertices = 0;        ///< Vertices of the mesh joined to another (seams.h).
    int nearlyJoined = 0;          ///< Vertices that would be joined but for round-off.
    int flatComponents = 0;        ///< Components without area, which do not change.
    int fixedVertices = 0;         ///< Vertices of the surface that must not move.
};

/// @param n      number of vertices of the mesh.
/// @param fixed  number of vertices of the surface that must not move.
SurfaceCounts countsOf(const Surface& surface, Index n, int components, Index fixed);

/// n integers, which all copies share.
class Labels {
  public:
    Labels(Eigen::VectorXi all = {}) : all_(std::make_shared<Eigen::VectorXi>(std::move(all))) {}
    int operator[](Index i) const { return (*all_)[i]; }
    const Eigen::VectorXi& operator*() const { return *all_; }
    const Eigen::VectorXi* operator->() const { return all_.get(); }

  private:
    std::shared_ptr<const Eigen::VectorXi> all_;
};

/// The connected components of a surface: triangles that share a vertex are connected.
struct Components {
    Labels label;  ///< n labels, 0 <= label < count; -1: no component.
    int count = 0;
};

/// @param F  m x 3 indices in [0, vertexCount); every vertex is in some triangle.
Components connectedComponents(const Faces& F, Index vertexCount);

}  // namespace spectral
