#pragma once

#include <Eigen/Core>

#include "core/analysis/bands.h"
#include "core/laplacian/constant_modes.h"
#include "core/laplacian/laplacian.h"
#include "core/ldlt/cholesky.h"
#include "core/support/progress.h"

namespace spectral {

/// Energies in octaves and in thirds of octaves.
struct BandEnergies {
    Eigen::VectorXd octaves;  ///< Of the shape.
    Eigen::VectorXd thirds;   ///< Of the shape.
    Eigen::VectorXd noise;    ///< Of the noise, in the thirds.
};

/// The energies x^T D g(sqrt(A)) x that signals beyond a basis have in every band g, without an
/// eigenvector: by Gauss quadrature in a shift-invert Krylov space with the pole in the middle of
/// the octave (lanczos.h; Golub and Meurant 1994), that grows until they stay as they are.
///
/// @param lastOfBasis  highest frequency of the basis; bands that end below are left 0.
/// @param shape  n x c signals that have no part in the basis; the energies of all add up.
/// @param noise  n, likewise.
BandEnergies energiesBeyond(const Bands& octaves, const Bands& thirds, const Laplacian& laplacian,
                            const ConstantModes& constants, double lastOfBasis,
                            const Eigen::MatrixXd& shape, const Eigen::VectorXd& noise,
                            ShiftedCholesky& cholesky, const Progress& progress);

}  // namespace spectral
