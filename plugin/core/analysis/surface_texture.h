#pragma once

#include "core/laplacian/laplacian_builder.h"
#include "core/support/progress.h"

namespace spectral {

/// Nesting indices of the filters of ISO 25178-2: wavelengths that are halved, length units.
struct TextureOptions {
    double waviness = 0.0;  ///< L-filter: what is larger is waviness, > 0.
    double noise = 0.0;     ///< S-filter: what is smaller is noise; 0: none.
    double form = 0.0;  ///< F-operator: what is larger is form, > waviness; 0: `kFormPerWaviness`.
    double creaseAngle = 60.0;  ///< Edges between planes that differ by more, degrees, have no
                                ///< texture; 180: all have.
    LaplacianKind laplacian = LaplacianKind::IntrinsicDelaunay;
};

/// At this form size the F-operator takes 6 % from waves of four cutoffs, of which the L-filter
/// leaves 4 %: the texture is still that of the L-filter, to .003.
constexpr double kFormPerWaviness = 8.0;

/// The roughness of a surface, S-L surface in the words of ISO 25178-2, and its parameters.
struct SurfaceTexture {
    Eigen::VectorXd height;  ///< n: height above the reference surface along its normal, length
                             ///< units; 0 where it is left out, and at unreferenced vertices.
    double Sa = 0.0;         ///< Mean of |height|, length units; the next five are lengths, too.
    double Sq = 0.0;         ///< Root mean square of the height.
    double Sp = 0.0, Sv = 0.0, Sz = 0.0;  ///< Highest peak, deepest valley, their sum.
    double Ssk = 0.0, Sku = 0.0;          ///< Skewness and kurtosis of the heights; 0 if Sq is 0.
    double Sdq = 0.0;                     ///< Root mean square of the slope.
    double Sdr = 0.0;   ///< Additional area of the surface, relative to the reference's.
    double area = 0.0;  ///< Of the reference surface where it is evaluated, length squared.
    int evaluated = 0;  ///< Number of vertices there.
    int leftOut = 0;    ///< Number of vertices within a cutoff of a boundary or crease.
    double errorEstimate = 0.0;  ///< Estimated largest error of the filtered coordinates, length.
    bool accuracyReached = false;
};

/// Transmission of the Gaussian filter of ISO 16610-61 at a frequency, 1/2 at the cutoff 2 pi /
/// size.
double standardGaussian(double omega, double size);

/// Separates the roughness of a surface from its form and waviness, and measures it.
///
/// The reference surface is the low-pass G_w X of the coordinates with the Laplacian A of the mesh
/// itself, in one step (Jiang, Cooper, Scott 2011); the height along its normals N is
/// h = (1 - G_f) <N, (G_n - G_w) X>, of waviness w, noise n, form f. Where the surface is curved a
/// low-pass draws it in: this offset is as large as its form and goes with it. Integrals are over
/// the reference surface. Where that has the radius of curvature r, roughness is transmitted as on
/// a plane up to a relative error of about (w / 2 pi r)^2: the metric is that of the rough surface.
///
/// @param V  n x 3 positions, finite.
/// @param F  m x 3 vertex indices, m >= 1; any topology, unreferenced vertices allowed.
/// @throws InvalidMesh, InvalidOption, SolverFailure, Cancelled
SurfaceTexture surfaceTexture(const Vertices& V, const Faces& F, const TextureOptions& options,
                              const Progress& progress = {});

}  // namespace spectral
