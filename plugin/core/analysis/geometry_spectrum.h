#pragma once

#include "core/laplacian/interior.h"
#include "core/laplacian/laplacian_builder.h"
#include "core/noise/diagnosis.h"
#include "core/support/progress.h"

namespace spectral {

struct SpectrumOptions {
    /// Number k >= 0 of individual harmonics to compute, including constant ones; they take most of
    /// the time. On a mesh of at most 2,000 vertices, clamped to all of them.
    int basisSize = 0;
    LaplacianKind laplacian = LaplacianKind::IntrinsicDelaunay;
    Boundary boundary = Boundary::Free;
};

/// The distribution of a shape over the sizes of its details.
///
/// Energies are integrals of squared lengths over the surface, length^4. An amplitude is the root
/// mean square height sqrt(energy / area) of a part of the spectrum; the squares of all amplitudes
/// sum to that of the shape. Only displacements across the surface count, not the distribution of
/// the vertices on it.
///
/// The shape is the signal U that a filter with the same boundary acts on: the positions X minus
/// the mean of every component or, with a fixed boundary, minus the harmonic extension of the
/// boundary positions (harmonic_extension.h). A free boundary has energy at all sizes, with an
/// amplitude that falls by 2^1.5 per octave, because no cosine has the slope of X there. A fixed
/// one has energy where the surface is curved, which falls by 2^2.5.
struct GeometrySpectrum {
    double diagonal = 0.0;         ///< Diagonal of the bounding box of all vertices, length units.
    double surfaceDiagonal = 0.0;  ///< The same without vertices that no triangle uses.
    double meanEdge = 0.0;         ///< Mean side length over all triangles, length units.
    double area = 0.0;             ///< Sum of D, length^2, including fixed vertices.
    double totalEnergy = 0.0;      ///< |U|_D^2, length^4.

    // The lowest harmonics: basisSize, or more so as not to split a multiple eigenvalue; or none.
    Eigen::VectorXd frequencies;  ///< omega_i, ascending, radians per length unit; constants: 0.
    Eigen::VectorXd amplitudes;   ///< |Phi_i^T D U| / sqrt(area), length units; constants: 0.

    // The octaves (bands.h), by descending feature size, down to the last that is not empty.
    Eigen::VectorXd octaveFeatureSizes;  ///< Centres: surfaceDiagonal times powers of two.
    Eigen::VectorXd octaveEnergies;      ///< >= 0, length^4; they sum to totalEnergy.
    Eigen::VectorXd octaveAmplitudes;    ///< sqrt(energy / area), length units.
    Eigen::VectorXd cumulativeEnergy;    ///< Energy of an octave and all larger ones relative to
                                         ///< totalEnergy, ascending to 1.

    /// Feature sizes at and above which 50, 90 and 99 % of the energy lie, length units: those of
    /// harmonics, or of Ritz values if harmonics are not computed.
    double featureSize50 = 0.0, featureSize90 = 0.0, featureSize99 = 0.0;

    // The third octaves (bands.h) that hold at least as much noise as 30 harmonics, by descending
    // feature size.
    Eigen::VectorXd bandFeatureSizes;  ///< Centres, length units.
    Eigen::VectorXd bandAmplitudes;    ///< Amplitudes of the shape, length units.
    Eigen::VectorXd bandNoise;  ///< Amplitudes of white noise of height 1 at all free vertices, >
                                ///< 0. bandAmplitudes / bandNoise is the noise height that would
                                ///< explain a band.

    Diagnosis diagnosis;            ///< Without positions.
    double noiseFeatureSize = 0.0;  ///< Below it there is more noise than shape (noise_floor.h);
                                    ///< 0: nowhere.

    /// Fraction of the energy that may be in another octave. Beyond the basis, the estimated error
    /// of the quadrature, whose energies are scaled to their known sum; in the basis, the energies
    /// of the harmonics times their relative residuals, which matter with needle triangles.
    double mismatch = 0.0;
};

/// The full spectrum of the coordinates in the manifold harmonics of the surface.
///
/// The coefficients Phi^T D U of the k lowest harmonics are exact (Vallet and Levy 2008). The
/// energies of the remainder of U are quadratic forms and need no harmonics: Gauss quadrature in a
/// few Krylov spaces gives them to about one per cent.
///
/// @param V  n x 3 positions, finite.
/// @param F  m x 3 vertex indices, m >= 1; any topology, unreferenced vertices allowed.
/// @throws InvalidMesh, InvalidOption, SolverFailure, Cancelled; InvalidOption also when a fixed
///         boundary leaves no vertex, or determines the whole shape, as on a plane.
GeometrySpectrum geometrySpectrum(const Vertices& V, const Faces& F, const SpectrumOptions& options,
                                  const Progress& progress = {});

}  // namespace spectral
