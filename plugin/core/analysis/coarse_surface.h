#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/laplacian/laplacian_builder.h"

namespace spectral {

/// A surface divided into cells of about one size, to low-pass at sizes of many cells: a hundredth
/// of the unknowns.
struct CoarseSurface {
    std::vector<int> cell;  ///< n, of each vertex.
    Laplacian laplacian;    ///< Of functions that are constant in each cell.

    /// Means of a signal over the cells.
    /// @param D  n vertex masses.
    Eigen::VectorXd meansOf(const Eigen::VectorXd& signal, const Eigen::VectorXd& D) const;

    /// The signal with a value for each cell, n.
    Eigen::VectorXd constantIn(const Eigen::VectorXd& values) const;
};

/// Functions constant in cells have the steps between them for gradients, with too much energy: the
/// stiffness is scaled so that the coordinates of a smooth surface have the energy that they should
/// have. Wavelengths are then met to a few percent.
///
/// @param smooth   n x 3 positions that vary little within a cell.
/// @param spacing  distance between the centres of neighbouring cells, length units.
CoarseSurface coarsened(const MeshLaplacian& mesh, const Vertices& smooth, double spacing);

}  // namespace spectral
