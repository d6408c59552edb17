#include "core/filter/signal_filter.h"

#include <cassert>
#include <cmath>
#include <string>

#include "core/filter/step_evaluator.h"
#include "core/krylov/krylov_spaces.h"
#include "core/mesh/mesh_check.h"
#include "core/mesh/surface.h"
#include "core/support/errors.h"
#include "core/support/frequency.h"
#include "core/support/threads.h"

namespace spectral {

namespace {

void checkSignal(const Eigen::MatrixXd& Q) {
    Index infinite = 0, first = -1;
    for (Index i = 0; i < Q.rows(); ++i)
        if (Q.row(i).array().isInf().any() && infinite++ == 0) first = i;
    if (infinite > 0)
        throw InvalidMesh(ErrorCode::ValueNotFinite,
                          std::to_string(infinite) +
                              (infinite == 1 ? " vertex has" : " vertices have") +
                              " an infinite value, the first is vertex " + std::to_string(first));
}

/// The triangles with data at all corners.
/// @param hasData  n.
Faces trianglesWithData(const Faces& F, const Eigen::Array<bool, Eigen::Dynamic, 1>& hasData) {
    Faces withData(F.rows(), 3);
    Index count = 0;
    for (Index t = 0; t < F.rows(); ++t)
        if (hasData[F(t, 0)] && hasData[F(t, 1)] && hasData[F(t, 2)])
            withData.row(count++) = F.row(t);
    if (count == 0)
        throw InvalidMesh(ErrorCode::NoData,
                          "no triangle has values at all of its corners: they are NaN");
    withData.conservativeResize(count, 3);
    return withData;
}

/// Whether X is constant on each component, to round-off: there is nothing to filter, and an error
/// relative to the size of the signal would be meaningless.
/// @param X  entries in [-1, 1].
bool isConstant(Eigen::MatrixXd X, const ConstantModes& constants) {
    constexpr double kRoundOff = 1e-13;
    constants.remove(X);
    return X.cwiseAbs().maxCoeff() <= kRoundOff;
}

}  // namespace

FilteredSignal filterSignal(const Vertices& V, const Faces& F, const Eigen::MatrixXd& Q,
                            const SignalFilterOptions& options, const Progress& progress) {
    assert(Q.rows() == V.rows() && Q.cols() >= 1 && Q.cols() <= kMaxSignals);
    const ThreadTeam team(progress);
    checkMesh(V, F);
    checkSignal(Q);
    checkWeights(options.part);
    const Eigen::Array<bool, Eigen::Dynamic, 1> hasData = !Q.array().isNaN().rowwise().any();
    const Faces withData = trianglesWithData(F, hasData);
    checkMesh(V, withData, options.laplacian);
    const Surface surface = joinedSurface(V, withData);
    const TransferFunction transfer(options.transferFunction, cutoffFrequency(options.featureSize));
    const Interior interior(surface.F, connectedComponents(surface.F, surface.X.rows()),
                            options.boundary);
    const LaplacianBuilder laplacians(surface, interior.surfaceComponents(), options.laplacian,
                                      BasisUpdate::None);
    const Laplacian& laplacian = laplacians.current();
    const EvaluationOptions evaluation;
    StepEvaluator evaluate(evaluation, interior, transfer);

    // Centred and scaled to 1: a large mean costs no digits, and squares cannot overflow.
    Eigen::MatrixXd X = restricted(Q, surface);
    X.rowwise() -= (0.5 * X.colwise().minCoeff() + 0.5 * X.colwise().maxCoeff()).eval();
    const double scale = X.cwiseAbs().maxCoeff();
    if (scale > 0.0) X /= scale;

    FilteredSignal result;
    static_cast<SurfaceCounts&>(result) =
        countsOf(surface, V.rows(), interior.surfaceComponents().count, interior.fixedVertices());
    result.Y = Q;
    result.accuracy = evaluation.accuracy;
    result.isConstant = isConstant(X, laplacian.constants);
    if (!result.isConstant) {
        // Kovnatsky et al. 2012, Eq. 6, with Q in place of the coordinates.
        const Evaluation filtered = evaluate(laplacian, X, 1.0, progress);
        const Eigen::MatrixXd change =
            vertexWeight(options.part, surface, interior, laplacian, options.featureSize)
                .asDiagonal() *
            (scale * (filtered.Y.front() - X));
        result.Y = changed(Q, surface, change);
        result.maxChange = change.cwiseAbs().maxCoeff();
        result.rmsChange = (laplacian.D.cwiseSqrt().asDiagonal() * change).eval().stableNorm() /
                           std::sqrt(laplacian.D.sum() * static_cast<double>(Q.cols()));
        result.errorEstimate = filtered.errorEstimate;
        result.accuracyReached = filtered.accuracyReached;
    }
    result.verticesWithoutData = static_cast<int>(hasData.size() - hasData.count());
    result.unreferencedVertices -= result.verticesWithoutData;
    result.cutoffFrequency = transfer.cutoff();
    static_cast<Work&>(result) = evaluate.work();
    result.residuals = evaluate.basis().residuals;
    return result;
}

}  // namespace spectral
