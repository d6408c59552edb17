#pragma once

#include "core/laplacian/laplacian_builder.h"
#include "core/support/progress.h"

namespace spectral {

struct ArtefactOptions {
    double featureSize = 0.0;  ///< Wavelength of the applied low-pass or band, length units, > 0.
    LaplacianKind laplacian = LaplacianKind::IntrinsicDelaunay;
};

struct Artefacts {
    double rms = 0.0;        ///< D-weighted root mean square of `length`, length units.
    double maximum = 0.0;    ///< Largest `length`, length units.
    Eigen::VectorXd length;  ///< n: length of the artefact part at each vertex, length units; 0 at
                             ///< unreferenced vertices.
    double errorEstimate = 0.0;  ///< Estimated largest error of `length`, length units.
};

/// Gain of the artefact-free part of a shape, g(lambda) = 1 / (1 + (lambda / (4 lambda_c))^4):
/// about 1 for features above the feature size, 1/2 at twice the cutoff frequency, 0 far beyond.
///
/// @param omega   frequency >= 0, radians per length unit; infinity is allowed.
/// @param cutoff  omega_c = sqrt(lambda_c) > 0.
double artefactFreeGain(double omega, double cutoff);

/// The artefacts a filter has left in a mesh: the part X - g(A) X of its coordinates above twice
/// the cutoff frequency.
///
/// A is the Laplacian of the mesh itself, not of the filter's input: the size of a spike is
/// measured on its own surface, and a spike longer than the feature size counts as shape. The
/// measure scales with the mesh and is invariant under rigid motion.
///
/// @param V  n x 3 positions, finite.
/// @param F  m x 3 vertex indices, m >= 1; any topology, unreferenced vertices allowed.
/// @throws InvalidMesh, InvalidOption, SolverFailure, Cancelled
Artefacts measureArtefacts(const Vertices& V, const Faces& F, const ArtefactOptions& options,
                           const Progress& progress = {});

}  // namespace spectral
