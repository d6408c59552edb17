#pragma once

#include <optional>
#include <vector>

#include "core/filter/step_evaluator.h"
#include "core/laplacian/interior.h"
#include "core/laplacian/laplacian_builder.h"
#include "core/laplacian/vertex_weight.h"
#include "core/mesh/creases.h"
#include "core/mesh/mesh.h"
#include "core/mesh/movement.h"
#include "core/mesh/surface.h"
#include "core/support/progress.h"
#include "core/support/types.h"
#include "core/transfer/transfer_function.h"

namespace spectral {

/// More passes, i.e. steps, make no difference, and take hours.
inline constexpr int kMaxPasses = 9;

/// Decisions of a whole surface, with which a tile of it is filtered in the same way.
struct WholeSurface {
    double meanEdge = 0.0;      ///< Mean edge length, length units.
    bool hasThinParts = false;  ///< Whether some tile has thin parts that must be kept.
    std::vector<bool> inner;    ///< n: what is not near where the tile was cut out.
};

struct FilterOptions {
    TransferFunctionOptions transferFunction;
    double featureSize = 0.0;  ///< Wavelength of the cutoff, 2 pi / omega_c, length units, > 0.
    int steps = 0;             ///< K >= 1: K steps of F^(1/K), the paper's scheme; 0: automatic.
    double tolerance = 0.0;    ///< For automatic steps: maximum distance from the result of
                               ///< infinitely many steps, over all but a thousandth of the input
                               ///< surface, length units; 0: defaultTolerance (measures.h).
    int maxSteps = 64;         ///< For automatic steps: limit, whatever the error, >= 2.
    int passes = 0;  ///< For automatic steps: exactly this many passes of 1, 2, 4, ... steps, up to
                     ///< kMaxPasses, whatever the error; 0: as many as the tolerance needs.
    bool keepThinParts = false;  ///< For a low-pass, over the full spectrum, of a size that nobody
                                 ///< chose: parts thinner than it stay (thin_parts.h).
    LaplacianKind laplacian = LaplacianKind::IntrinsicDelaunay;
    BasisUpdate basisUpdate = BasisUpdate::Conformal;
    double conformalShare = 0.0;  ///< For BasisUpdate::Full, 0 to 1; see laplacian_builder.h.
    Boundary boundary = Boundary::Free;
    double creaseAngle = 0.0;  ///< Edges with a larger dihedral angle stay in place, and nothing
                               ///< is filtered across them, degrees; 0: no creases.
    EvaluationOptions evaluation;

    WeightOptions part;                 ///< Where to filter.
    std::optional<WholeSurface> whole;  ///< If the mesh is a tile of a larger surface.
    double maxDisplacement = 0.0;       ///< Bound on the displacement of every vertex, length
                                        ///< units (displacement_limit.h); 0: none.
    bool preserveVolume = false;        ///< Restores the volume of closed components (volume.h).
};

/// Displacements are weighted by the areas of the input.
struct FilterResult : SurfaceCounts, Movement, Work {
    Vertices V;  ///< The filtered positions; unreferenced vertices do not move.

    int steps = 0;                 ///< K; of automatic steps, those of the last pass.
    int passes = 0;                ///< Passes of automatic steps; 0: the paper's scheme.
    double cutoffFrequency = 0.0;  ///< omega_c, radians per length unit.
    double featureSize = 0.0;      ///< 2 pi / omega_c, length units.
    double areaBefore = 0.0, areaAfter = 0.0;
    RoundedCreases roundedCreases;  ///< None with creases that stay.
    double meanEdge = 0.0;          ///< Mean edge length of the input.
    double shrunkenPart = 0.0;  ///< Fraction of the input surface at vertices that keep less than a
                                ///< tenth of their area: it shrinks to lines and points.
    double accuracy = 0.0;      ///< Requested relative accuracy of the evaluation, all steps.
    double errorEstimate = 0.0;   ///< Estimated relative error of the evaluation, all steps.
    bool accuracyReached = true;  ///< Whether every step was within its share of `accuracy`.
    double stepError = 0.0;       ///< Automatic steps: estimated error, that of the evaluations
                             ///< included, over all but a thousandth of the input surface, without
                             ///< what collapses (shrunkenPart), length units.
    bool toleranceReached = true;  ///< Automatic steps: whether the estimated error is within the
                                   ///< tolerance on all but a thousandth of the input surface, what
                                   ///< collapses included.
    double singularPart = 0.0;     ///< Automatic steps: fraction of the input surface on which the
                                   ///< estimated error exceeds the tolerance.
    double thinPartFactor = 1.0;   ///< Largest factor of keepThinParts, applied or not.
    bool cutoffReached = true;     ///< Truncated spectrum: whether the harmonics reach omega_c.
    std::vector<double> stepSizes;  ///< The fractional power alpha of each step; they sum to 1.

    // The last computed basis: that of the last step, or of the input if no other was needed.
    Eigen::VectorXd eigenvalues;  ///< k, ascending; empty without a basis.
    Eigen::VectorXd residuals;    ///< k, relative (see HarmonicBasis); empty for a dense basis.
    int inertiaCount = 0;         ///< Harmonics the basis must hold, by inertia; 0 for a dense one.
    int computedBases = 0;        ///< Number of bases computed in all steps.
};

/// Filters the geometry of a mesh: K steps X <- F^(1/K)(sqrt(A)) X, with the Laplacian A of the
/// current shape in every step (Kovnatsky et al. 2012, Eq. 11), or the limit of infinitely many
/// steps, to a tolerance.
///
/// Each step preserves the area-weighted centroid of every connected component without a fixed
/// boundary, to round-off.
///
/// @param V  n x 3 positions, finite.
/// @param F  m x 3 vertex indices, m >= 1; any topology, unreferenced vertices allowed.
/// @throws InvalidMesh, InvalidOption, SolverFailure, Cancelled
FilterResult fractionalFilter(const VerticesView& V, const FacesView& F,
                              const FilterOptions& options, const Progress& progress = {});

}  // namespace spectral
