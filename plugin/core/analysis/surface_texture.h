#pragma once

#include <vector>

#include "core/analysis/autocorrelation.h"
#include "core/analysis/height_statistics.h"
#include "core/analysis/texture_filters.h"
#include "core/laplacian/laplacian_builder.h"
#include "core/support/progress.h"

namespace spectral {

/// What of a surface is its form, and no texture (the F-operator).
enum class FormKind {
    Size,      ///< What varies more slowly than a size.
    None,      ///< Nothing: where it is curved, a low-pass draws it in, which adds to the heights.
    Plane,     ///< The plane nearest to the evaluated vertices: least squares over its area.
    Sphere,    ///< The nearest sphere.
    Cylinder,  ///< The nearest cylinder.
};

/// Whether heights are distances from a fitted shape.
constexpr bool isShape(FormKind form) { return form >= FormKind::Plane; }

/// Nesting indices of the filters of ISO 25178-2: wavelengths that are halved, length units.
struct TextureOptions {
    double waviness = 0.0;  ///< L-filter: what is larger is waviness, > 0; 0: none, with a plane,
                            ///< sphere or cylinder.
    double noise = 0.0;     ///< S-filter: what is smaller is noise; 0: none.
    FormKind form = FormKind::Size;
    double formSize = 0.0;       ///< For FormKind::Size, > waviness; 0: `kFormPerWaviness` of that.
    double creaseAngle = 50.0;   ///< Edges between planes that differ by more, degrees, have no
                                 ///< texture; 180: all have.
    std::vector<bool> selected;  ///< n, whether to measure each vertex; empty: all.
    LaplacianKind laplacian = LaplacianKind::IntrinsicDelaunay;
};

/// At this form size the F-operator takes 6 % from waves of four cutoffs, of which the L-filter
/// leaves 4 %: the texture is still that of the L-filter, to .003.
constexpr double kFormPerWaviness = 8.0;

/// The largest hole that is points missing, relative to the cutoff: the filters see the mean of its
/// rim there, and peaks next to it are .6 % off at a width of .21 cutoffs, 5 % at .35. At a larger
/// one, the surface ends.
constexpr double kHolePerCutoff = 0.25;

/// The roughness of a surface, S-L surface in the words of ISO 25178-2, and its parameters.
struct SurfaceTexture : TextureParameters {
    TextureLengths lengths;   ///< Of a height map.
    Eigen::VectorXd height;   ///< n: height above the reference surface along its normal, length
                              ///< units; 0 where it is left out, and at unreferenced vertices.
    int evaluated = 0;        ///< Number of vertices that count.
    int leftOut = 0;          ///< Number of selected vertices within a cutoff of an end, or not on
                              ///< the fitted shape.
    double leftOutSq = 0.0;   ///< Root mean square height of those near a boundary, length.
    int tooThin = 0;          ///< Of others, left out on parts that the low-pass draws together.
    int firstTooThin = -1;    ///< The first of these, a row of V; -1: none.
    double formRadius = 0.0;  ///< Of the sphere or cylinder, length units; 0: none.
    double errorEstimate = 0.0;  ///< Estimated error of the heights, root mean square, length.
    bool accuracyReached = false;
};

/// Separates the roughness of a surface from its form and waviness, and measures it.
///
/// G_w, G_n, G_f are the low-passes of waviness w, noise n and form size f, of a Laplacian (Jiang,
/// Cooper, Scott 2011), in one step each:
/// - From a plane, sphere or cylinder, at the distance d along its normals N, h = (G_n - G_w) d.
///   The Laplacian is that of the projection X - d N onto the shape: wavelengths are measured on
///   the form, whatever the slopes, and waves are transmitted as the standard says.
/// - On other shapes it is that of the mesh itself or, where roughness is steep, of the
///   projection X - h N, again until that is smooth. The reference surface is G_w X, and the height
///   along its normals N is h = (1 - G_f) <N, (G_n - G_w) X>. Where the surface is curved a
///   low-pass draws it in: this offset is as large as its form and goes with it. G_f is a mean over
///   what is far from ends.
/// Integrals are over the reference surface, which is also that without roughness.
///
/// Left out is what is within a cutoff of where the surface ends: its boundary but for small holes
/// (kHolePerCutoff), and creases of the form; a fitted shape has none. A crease is an edge between
/// planes of different directions at which the low-passed surface turns as far.
///
/// On shapes that are not fitted, coordinates are vectors, whose directions turn around a curved
/// surface: on a cylinder of radius r, m waves around it keep ((1 - 1/m) H(m + 1) + (1 + 1/m) H(m -
/// 1)) / 2 in place of H(m), .479 in place of .5 at a cutoff of r, .495 at half of it.
///
/// @param V  n x 3 positions, finite.
/// @param F  m x 3 vertex indices, m >= 1; any topology, unreferenced vertices allowed.
/// @throws InvalidMesh, InvalidOption, SolverFailure, Cancelled
SurfaceTexture surfaceTexture(const Vertices& V, const Faces& F, const TextureOptions& options,
                              const Progress& progress = {});

}  // namespace spectral
