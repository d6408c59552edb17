#pragma once

#include "core/laplacian/interior.h"
#include "core/laplacian/laplacian_builder.h"
#include "core/mesh/mesh.h"
#include "core/support/progress.h"
#include "core/support/types.h"

namespace spectral {

struct SpectrumOptions {
    /// k >= 1, the harmonics that are computed, the constant ones included. A mesh of no more
    /// vertices, up to 2,000 of them, gets all it has.
    int basisSize = 200;
    LaplacianKind laplacian = LaplacianKind::IntrinsicDelaunay;
    Boundary boundary = Boundary::Free;
};

/// How much of a shape is in details of which size.
///
/// Energies are integrals of squared lengths over the surface, length^4. An amplitude is the root
/// mean square height sqrt(energy / area) that a part of the spectrum contributes to the shape, a
/// length: those of all parts, squared, sum to that of the shape. Vertices that lie unevenly within
/// the surface do not count, only what is across it.
///
/// The shape is what a filter with the same boundary acts on, the signal U: the positions X less
/// their mean on every component; or, with a fixed boundary, X less the harmonic extension of the
/// boundary's positions (harmonic_extension.h), which is 0 there. A free boundary counts at all
/// sizes, its amplitude falls by 2^1.5 per octave: no cosine has the slope of X there. A fixed one
/// counts where the surface is curved, by 2^2.5.
struct GeometrySpectrum {
    double diagonal = 0.0;     ///< Of the bounding box of all vertices, length units.
    double meanEdge = 0.0;     ///< Mean length of the triangles' sides.
    double area = 0.0;         ///< Sum of D, length^2, fixed vertices included.
    double totalEnergy = 0.0;  ///< |U|_D^2, length^4.

    /// Of the lowest harmonics, at least basisSize of them as no group of equal ones is cut.
    Eigen::VectorXd frequencies;  ///< omega_i, ascending, radians per length unit; constants: 0.
    Eigen::VectorXd amplitudes;   ///< |Phi_i^T D U| / sqrt(area), length units; constants: 0.

    /// Of the octaves (bands.h), from large feature sizes to small ones, down to the last one
    /// that holds anything of the shape.
    Eigen::VectorXd octaveFeatureSizes;  ///< Middles: diagonal times powers of two, length units.
    Eigen::VectorXd octaveEnergies;      ///< >= 0, length^4; they sum to totalEnergy.
    Eigen::VectorXd octaveAmplitudes;    ///< sqrt(energy / area), length units.
    Eigen::VectorXd cumulativeEnergy;    ///< Part of the energy in this octave and all larger ones,
                                         ///< ascending to 1.

    /// Feature sizes at and above which 50, 90 and 99 % of the energy are, length units.
    double featureSize50 = 0.0, featureSize90 = 0.0, featureSize99 = 0.0;

    /// Of thirds of octaves (bands.h), from large feature sizes to small ones, those that hold as
    /// much as 30 of all harmonics.
    Eigen::VectorXd bandFeatureSizes;  ///< Middles, length units.
    Eigen::VectorXd bandAmplitudes;    ///< Of the shape, length units.
    Eigen::VectorXd bandNoise;         ///< Of white noise of the vertices that are not fixed, of
                                       ///< height 1 across the surface; > 0. bandAmplitudes over
                                       ///< these is the height of noise that would explain a band.

    // Where the shape is no more than such noise (noise_floor.h); 0 where that is not seen.
    double noiseHeight = 0.0;       ///< Its root mean square height, length units.
    double noiseFeatureSize = 0.0;  ///< It begins there: all smaller details are like it.

    /// Part by which the octave energies beyond the basis missed their known sum, before they were
    /// scaled to it; 0 where the basis is the whole spectrum.
    double mismatch = 0.0;
};

/// The spectrum of the coordinates in the manifold harmonics of the surface, all of it.
///
/// The k lowest harmonics are computed, their coefficients Phi^T D U are exact (Vallet and Levy
/// 2008). For the remainder of U no eigenvector is: its energies are quadratic forms
/// (band_energies.h). Taking the basis out of U first keeps the large energies of the large
/// features from drowning those of the details.
///
/// @param V  n x 3 positions, finite.
/// @param F  m x 3 vertex indices, m >= 1; any topology, unreferenced vertices allowed.
/// @throws InvalidMesh, InvalidOption, SolverFailure, Cancelled; InvalidOption also when a fixed
///         boundary leaves nothing: no vertex, or a shape that the boundary determines, as a plane.
GeometrySpectrum geometrySpectrum(const Vertices& V, const Faces& F, const SpectrumOptions& options,
                                  const Progress& progress = {});

}  // namespace spectral
