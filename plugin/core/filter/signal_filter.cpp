#include "core/filter/signal_filter.h"

#include <cassert>
#include <cmath>
#include <string>

#include "core/filter/step_evaluator.h"
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

/// Whether a signal is constant on each component, to round-off: there is nothing to filter, and an
/// error relative to the size of the signal would be meaningless.
/// @param x  n entries in [-1, 1].
bool isConstant(Eigen::MatrixXd x, const Laplacian& laplacian) {
    constexpr double kRoundOff = 1e-13;
    laplacian.constants.remove(laplacian.D, x);
    return x.cwiseAbs().maxCoeff() <= kRoundOff;
}

/// Centres each signal and scales it to 1: a large mean costs no digits, squares cannot overflow,
/// and each is filtered as accurately as alone. A constant signal becomes 0.
/// @return  the scale of each signal; 0 if it is constant.
Eigen::RowVectorXd normalize(const Laplacian& laplacian, Eigen::MatrixXd& X) {
    X.rowwise() -= (0.5 * X.colwise().minCoeff() + 0.5 * X.colwise().maxCoeff()).eval();
    Eigen::RowVectorXd scale = X.cwiseAbs().colwise().maxCoeff();
    for (Index c = 0; c < X.cols(); ++c) {
        if (scale[c] > 0.0) X.col(c) /= scale[c];
        if (!isConstant(X.col(c), laplacian)) continue;
        X.col(c).setZero();
        scale[c] = 0.0;
    }
    return scale;
}

/// @param change  n x c, on the surface.
SignalChange changeOf(const Eigen::Ref<const Eigen::MatrixXd>& change, const Eigen::VectorXd& D) {
    return {false,
            (D.cwiseSqrt().asDiagonal() * change).eval().stableNorm() /
                std::sqrt(D.sum() * static_cast<double>(change.cols())),
            change.cwiseAbs().maxCoeff()};
}

}  // namespace

FilteredSignal filterSignal(const Vertices& V, const Faces& F, const Eigen::MatrixXd& Q,
                            const SignalFilterOptions& options, const Progress& progress) {
    assert(Q.rows() == V.rows() && Q.cols() >= 1);
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

    Eigen::MatrixXd X = restricted(Q, surface);
    const Eigen::RowVectorXd scale = normalize(laplacian, X);

    FilteredSignal result;
    static_cast<SurfaceCounts&>(result) =
        countsOf(surface, V.rows(), interior.surfaceComponents().count, interior.fixedVertices());
    result.Y = Q;
    result.accuracy = evaluation.accuracy;
    result.isConstant = scale.isZero(0.0);
    result.columns.assign(static_cast<std::size_t>(Q.cols()), {true, 0.0, 0.0});
    if (!result.isConstant) {
        // Kovnatsky et al. 2012, Eq. 6, with Q in place of the coordinates.
        const Evaluation filtered = evaluate(laplacian, X, 1.0, progress);
        const Eigen::MatrixXd change =
            vertexWeight(options.part, surface, interior, laplacian, options.featureSize)
                .asDiagonal() *
            (filtered.Y.front() - X) * scale.asDiagonal();
        result.Y = changed(Q, surface, change);
        static_cast<SignalChange&>(result) = changeOf(change, laplacian.D);
        for (Index c = 0; c < Q.cols(); ++c)
            if (scale[c] > 0.0) result.columns[c] = changeOf(change.col(c), laplacian.D);
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
