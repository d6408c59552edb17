#pragma once

#include <vector>

#include "core/filter/step_evaluator.h"
#include "core/laplacian/interior.h"
#include "core/laplacian/laplacian_builder.h"
#include "core/laplacian/vertex_weight.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
#include "core/mesh/volume.h"
#include "core/support/progress.h"
#include "core/support/types.h"
#include "core/transfer/transfer_function.h"

namespace spectral {

struct FilterOptions {
    TransferFunctionOptions transferFunction;
    double featureSize = 0.0;  ///< Wavelength of the cutoff, 2 pi / omega_c, length units, > 0.
    int steps = 0;             ///< K >= 1: K steps of F^(1/K), the paper's scheme; 0: automatic.
    double tolerance = 0.0;    ///< For automatic steps: largest distance from the result of
                               ///< infinitely many steps, over all but a thousandth of the filtered
                               ///< surface, length units, > 0.
    int mostSteps = 64;        ///< For automatic steps: where they end, whatever the error, >= 2.
    LaplacianKind laplacian = LaplacianKind::IntrinsicDelaunay;
    BasisUpdate basisUpdate = BasisUpdate::Conformal;
    double conformalShare = 0.0;  ///< For BasisUpdate::Full, 0 to 1; see laplacian_builder.h.
    Boundary boundary = Boundary::Free;
    double creaseAngle = 0.0;  ///< Edges of a larger dihedral angle stay where they are, and
                               ///< nothing is filtered across them, degrees; 0: no edge.
    EvaluationOptions evaluation;

    WeightOptions part;           ///< Where to filter.
    bool preserveVolume = false;  ///< Gives closed components their volume back (volume.h).
};

struct FilterResult : SurfaceCounts {
    Vertices V;  ///< The filtered positions; unreferenced vertices stay where they are.

    int steps = 0;
    double cutoffFrequency = 0.0;  ///< omega_c, radians per length unit.
    double featureSize = 0.0;      ///< 2 pi / omega_c, length units.
    double maxDisplacement = 0.0;  ///< Largest vertex displacement, length units.
    double rmsDisplacement = 0.0;  ///< Root mean square over the input's surface.
    double areaBefore = 0.0, areaAfter = 0.0;
    double volumeBefore = 0.0, volumeAfter = 0.0;  ///< Signed; a volume where there is one.
    bool hasVolume = false;                        ///< Whether the surface encloses one.
    double meanEdge = 0.0;                         ///< Mean edge length of the input.
    double shrunkenPart = 0.0;  ///< Part of the input's surface, 0 to 1, at vertices that keep less
                                ///< than a tenth of their area: it shrinks to lines and points.
    PreservedVolumes volumes;   ///< With preserveVolume.
    int factorizations = 0;     ///< Sparse LDL^T factorizations.
    int solves = 0;             ///< Solves with one right-hand side.
    int products = 0;           ///< Of the Laplacian with one column.
    bool lacksMemory = false;   ///< Whether products took the place of a factorization that there
                                ///< was no memory for: the same result, but slower.
    double accuracy = 0.0;      ///< Requested accuracy of the evaluation, relative, all steps.
    double errorEstimate = 0.0;   ///< Estimated error of the evaluation, relative, all steps.
    bool accuracyReached = true;  ///< Whether every step was within its share of `accuracy`.
    double stepError = 0.0;  ///< Automatic steps: estimated error over all but a thousandth of the
                             ///< filtered surface, length units.
    bool toleranceReached = true;  ///< Automatic steps: whether stepError is within it.
    double singularPart = 0.0;  ///< Automatic steps: part of the input's surface, 0 to 1, on which
                                ///< the estimated error is above the tolerance.
    bool cutoffReached = true;  ///< Truncated spectrum: whether the harmonics reach omega_c.
    std::vector<double> stepSizes;  ///< The fractional powers alpha, in their order; sum 1.

    // The last basis that was computed: that of the last step, or of the input where no other was
    // needed.
    Eigen::VectorXd eigenvalues;  ///< k, ascending; empty without a basis.
    Eigen::VectorXd residuals;    ///< k, relative (see HarmonicBasis); empty for a dense basis.
    int inertiaCount = 0;         ///< Harmonics that the basis must hold; 0 for a dense basis.
    int computedBases = 0;        ///< Bases computed in all steps.
};

/// Filters the geometry of a mesh: K steps X <- F^(1/K)(sqrt(A)) X, with the Laplacian A of the
/// current shape in every step (Kovnatsky et al. 2012, Eq. 11), or the limit of infinitely many
/// steps, to a tolerance.
///
/// Every connected component without a fixed boundary keeps its area-weighted centroid in each
/// step, to round-off.
///
/// @param V  n x 3 positions, finite.
/// @param F  m x 3 vertex indices, m >= 1; any topology, unreferenced vertices allowed.
/// @throws InvalidMesh, InvalidOption, SolverFailure, Cancelled
FilterResult fractionalFilter(const Vertices& V, const Faces& F, const FilterOptions& options,
                              const Progress& progress = {});

}  // namespace spectral
