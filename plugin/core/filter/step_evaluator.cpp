#include "core/filter/step_evaluator.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>

#include "core/support/errors.h"

namespace spectral {

namespace {

/// Even a signal that is negligible compared with the shape gets two digits.
constexpr double kCoarsestAccuracy = 1e-2;

/// Relative error of a predicted shape: that of its step, but at least three digits. It affects the
/// result only through the change of the Laplacian, but that change is large where parts shrink
/// away.
constexpr double kPredictionAccuracy = 1e-3;

/// Relative error beyond which a result is useless.
constexpr double kUselessError = 0.1;

/// @throws InvalidOption  when neither a Krylov space nor a basis can evaluate F.
void requireOneResidualGain(const TransferFunction& F) {
    if (F.isConstantBeyondJumps()) return;
    std::ostringstream text;
    text << "transfer_function jumps at w = " << F.discontinuities().back() / F.cutoff()
         << " and is not constant beyond it: replace the jump by a smooth fall, e.g. "
            "1/(1 + w^16) for w < 1, or choose spectrum = truncated";
    throw InvalidOption(text.str());
}

std::unique_ptr<Evaluator> evaluatorFor(const EvaluationOptions& options,
                                        const TransferFunction& F) {
    if (options.spectrum == Spectrum::Truncated)
        return std::make_unique<BasisEvaluator>(F, options.truncation);
    // A rational Krylov space approximates smooth gains; a jump needs the eigenvectors below it.
    if (!F.discontinuities().empty()) {
        requireOneResidualGain(F);
        return std::make_unique<BasisEvaluator>(F, std::nullopt);
    }
    return std::make_unique<FullSpectrumEvaluator>(F, options.accuracy, options.atEveryVertex,
                                                   options.solver, options.finerByProducts);
}

}  // namespace

StepEvaluator::StepEvaluator(const EvaluationOptions& options, const Interior& interior,
                             const TransferFunction& F)
    : accuracy_(options.accuracy),
      interior_(interior),
      extension_(interior),
      evaluator_(evaluatorFor(options, F)) {}

Evaluation StepEvaluator::operator()(const Laplacian& surface, const Signals& X, double alpha,
                                     const Progress& progress) {
    return evaluate(surface, X, {alpha}, {accuracyOfStep(accuracy_, alpha)}, progress);
}

Evaluation StepEvaluator::predict(const Laplacian& surface, const Signals& X,
                                  const std::vector<double>& alphas, const Progress& progress,
                                  bool areOthersCompared) {
    const double step = std::min(1.0, 2.0 * alphas.front());  // which it is in the middle of
    const double accuracy = std::min(accuracyOfStep(accuracy_, step), kPredictionAccuracy);
    return evaluate(surface, X, alphas, {accuracy, areOthersCompared}, progress);
}

Evaluation StepEvaluator::evaluate(const Laplacian& surface, const Signals& X,
                                   const std::vector<double>& alphas, Accuracy accuracy,
                                   const Progress& progress) {
    requireUsable(surface);
    if (interior_.size() == 0) return {std::vector<Eigen::MatrixXd>(alphas.size(), X)};
    // Kovnatsky et al. 2012, Eq. 11: one step.
    if (interior_.isWhole()) {
        Evaluation whole = evaluator_->evaluate(surface, X, alphas, accuracy, progress);
        requireUsefulAccuracy(whole.errorEstimate);
        return whole;
    }

    progress.report(0.0, "factorizing");
    const Laplacian inside = interior_.restricted(surface);
    const auto [U, relativeSize] = extension_.remainder(surface, inside, X);
    if (relativeSize < 1.0)
        accuracy.value = std::min(accuracy.value / relativeSize, kCoarsestAccuracy);
    Evaluation evaluation = evaluator_->evaluate(inside, U, alphas, accuracy, progress);
    evaluation.errorEstimate *= relativeSize;
    requireUsefulAccuracy(evaluation.errorEstimate);
    for (Eigen::MatrixXd& Y : evaluation.Y)
        Y = X + interior_.extended(Y - U);  // exactly X on the boundary
    return evaluation;
}

void requireUsefulAccuracy(double errorEstimate) {
    if (!(errorEstimate > kUselessError)) return;
    throw SolverFailure(
        ErrorCode::TooSteep,
        "the transfer function is too steep, or triangles are needles: the relative error is " +
            (std::isfinite(errorEstimate) ? "about " + textOf(errorEstimate) : "unknown"));
}

}  // namespace spectral
