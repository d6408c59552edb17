#pragma once

#include "core/laplacian/frequency.h"
#include "core/laplacian/laplacian_builder.h"
#include "core/mesh/mesh.h"
#include "core/support/progress.h"
#include "core/support/types.h"

namespace spectral {

struct ArtefactOptions {
    double featureSize = 0.0;  ///< L, of the low-pass or the band that was applied: its wavelength,
                               ///< length units, > 0.
    LaplacianKind laplacian = LaplacianKind::IntrinsicDelaunay;
};

struct Artefacts {
    double rms = 0.0;            ///< D-weighted root mean square of `length`, length units.
    double maximum = 0.0;        ///< Largest `length`, length units.
    Eigen::VectorXd length;      ///< Of the artefact part at every vertex, n, length units; 0 at
                                 ///< unreferenced vertices.
    double errorEstimate = 0.0;  ///< Estimated error of `length` at any vertex, length units.
};

/// Gain of the part of a shape that is no artefact, g(lambda) = 1 / (1 + (lambda / (4
/// lambda_c))^4): 1 for what is larger than the feature size, 1/2 at twice the cutoff frequency
/// (lambda = 4 lambda_c), and soon 0 beyond.
///
/// @param omega   frequency >= 0, radians per length unit; infinity is allowed.
/// @param cutoff  omega_c = sqrt(lambda_c) > 0.
double artefactFreeGain(double omega, double cutoff);

/// The artefacts that a filter has left in a mesh: the part X - g(A) X of its coordinates that lies
/// above twice the cutoff in the mesh's own spectrum.
///
/// A is the Laplacian of the mesh itself, not of the filter's input: a spike counts by its size on
/// its own surface, and one that is longer than the feature size is a part of the shape. The
/// measure scales with the mesh and does not change under rigid motion.
///
/// @param V  n x 3 positions, finite.
/// @param F  m x 3 vertex indices, m >= 1; any topology, unreferenced vertices allowed.
/// @throws InvalidMesh, InvalidOption, SolverFailure, Cancelled
Artefacts measureArtefacts(const Vertices& V, const Faces& F, const ArtefactOptions& options,
                           const Progress& progress = {});

}  // namespace spectral
