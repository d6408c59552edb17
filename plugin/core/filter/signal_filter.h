#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/filter/evaluator.h"
#include "core/laplacian/interior.h"
#include "core/laplacian/laplacian_builder.h"
#include "core/laplacian/vertex_weight.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
#include "core/support/progress.h"
#include "core/transfer/transfer_function.h"

namespace spectral {

struct SignalFilterOptions {
    TransferFunctionOptions transferFunction;
    double featureSize = 0.0;  ///< Wavelength of the cutoff, 2 pi / omega_c, length units, > 0.
    LaplacianKind laplacian = LaplacianKind::IntrinsicDelaunay;
    Boundary boundary = Boundary::Free;
    WeightOptions part;  ///< Where to filter.
};

/// What a filter has changed in one signal, or in all together.
struct SignalChange {
    bool isConstant = false;  ///< Constant on each component: nothing to filter.
    double rmsChange = 0.0;   ///< RMS of Y - Q over the surface, units of Q.
    double maxChange = 0.0;   ///< Largest modulus of an entry of Y - Q.
};

struct FilteredSignal : SurfaceCounts, Work, SignalChange {
    Eigen::MatrixXd Y;  ///< n x c, the filtered signals; Q at vertices not on the surface.
    std::vector<SignalChange> columns;  ///< c, of each signal.

    int verticesWithoutData = 0;   ///< Vertices with a NaN, unchanged.
    double cutoffFrequency = 0.0;  ///< omega_c, radians per length unit.
    double accuracy = 0.0;         ///< Requested accuracy, relative like errorEstimate.
    double errorEstimate = 0.0;    ///< Estimated error of Y, relative to the largest modulus of
                                   ///< each signal without its means, the largest of all signals.
    bool accuracyReached = true;   ///< Whether errorEstimate is within the accuracy.
    Eigen::VectorXd residuals;     ///< Residuals of the harmonics, if F needs any (HarmonicBasis).
};

/// Filters any number of signals on a mesh, such as vertex qualities or colours: Y = F(sqrt(A)) Q
/// over the whole spectrum of the Laplacian A (Kovnatsky et al. 2012, Eq. 6). The shape does not
/// change, so there is one evaluation, without steps, and one factorization for all signals.
///
/// Every connected component keeps the area-weighted mean of each signal, whatever F(0) is. With a
/// fixed boundary the values there are kept instead, and F acts on the rest of the signal
/// (harmonic_extension.h). Values that F does not change are left bit for bit.
///
/// A vertex with a NaN has no data. The surface consists of the triangles with data at all corners;
/// it has a natural boundary towards the others.
///
/// @param V  n x 3 positions, finite.
/// @param F  m x 3 vertex indices, m >= 1; any topology, unreferenced vertices allowed.
/// @param Q  n x c values, not infinite, c >= 1.
/// @throws InvalidMesh  as checkMesh, and when a value is infinite, or no triangle has data.
/// @throws InvalidOption, SolverFailure, Cancelled
FilteredSignal filterSignal(const Vertices& V, const Faces& F, const Eigen::MatrixXd& Q,
                            const SignalFilterOptions& options, const Progress& progress = {});

}  // namespace spectral
