#include "core/filter/full_spectrum_evaluator.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/support/errors.h"

namespace spectral {

namespace {

/// Products per column that cost as much as a factorization and its solves, for n vertices: a fit
/// to measurements. There are more after the first evaluation: if products sufficed there, a
/// symbolic analysis would pay off over fewer evaluations.
int affordableProducts(Index n, bool isFirst) {
    return static_cast<int>((isFirst ? 150.0 : 220.0) *
                            std::pow(static_cast<double>(n) / 1e5, 0.2));
}

Evaluation joined(std::vector<FullSpectrumResult> results) {
    Evaluation evaluation;
    for (FullSpectrumResult& result : results) {
        evaluation.errorEstimate = std::max(evaluation.errorEstimate, result.errorEstimate);
        evaluation.accuracyReached = evaluation.accuracyReached && result.converged;
        evaluation.Y.push_back(std::move(result.Y));
    }
    return evaluation;
}

}  // namespace

Evaluation evaluateInKrylovSpaces(const Laplacian& laplacian, const ShiftedLdlt& ldlt,
                                  const std::vector<Gain>& gains, const Signals& X,
                                  FullSpectrumOptions options, const Progress& progress) {
    const bool hasFixedBoundary = laplacian.constants.label().minCoeff() < 0;
    if (options.atEveryVertex || hasFixedBoundary)
        options.roundOffAtVertices = roundOffAtVertices(ldlt, laplacian);
    // With a fixed boundary, solutions may contain constants.
    if (hasFixedBoundary) options.roundOff = *options.roundOffAtVertices;
    return joined(applyFullSpectrum(laplacian, ShiftInvert(ldlt), gains, X, options, progress));
}

/// The pole is chosen for the spectrum of the first Laplacian; later ones are similar.
double FullSpectrumEvaluator::poleFor(const Laplacian& laplacian, double alpha) {
    if (!spectrum_) spectrum_ = bulkSpectrum(laplacian);
    const auto [place, isNew] = poles_.try_emplace(alpha);
    if (isNew)
        place->second = selectPole(fractionalPower(F_, alpha), F_.cutoff(), *spectrum_,
                                   accuracyOfStep(accuracy_, alpha));
    return place->second;
}

FullSpectrumOptions FullSpectrumEvaluator::optionsFor(double accuracy) const {
    FullSpectrumOptions options;
    options.accuracy = accuracy;
    options.atEveryVertex = atEveryVertex_;
    options.samples = F_.samples();
    return options;
}

std::vector<Gain> FullSpectrumEvaluator::gainsFor(const std::vector<double>& alphas) const {
    std::vector<Gain> gains;
    for (const double alpha : alphas) gains.push_back(fractionalPower(F_, alpha));
    return gains;
}

Evaluation FullSpectrumEvaluator::evaluate(const Laplacian& laplacian, const Signals& X,
                                           const std::vector<double>& alphas,
                                           const Accuracy& accuracy, const Progress& progress) {
    const std::vector<Gain> gains = gainsFor(alphas);
    if (auto evaluation = evaluateByProducts(laplacian, gains, X, accuracy, progress))
        return *std::move(evaluation);
    const StopPoint stop = [&] { progress.report(0.0, "factorizing"); };
    stop();
    const double pole = poleFor(laplacian, alphas[alphas.size() / 2]);
    try {
        ldlt_.factorizeDefinite(laplacian.W, laplacian.D, pole, stop);
    } catch (const Error& error) {
        if (error.code() != ErrorCode::OutOfMemory || solver_ == Solver::Factorization) throw;
        lacksMemory_ = true;
        if (auto evaluation = evaluateByProducts(laplacian, gains, X, accuracy, progress))
            return *std::move(evaluation);
        throw;
    }
    return evaluateInKrylovSpaces(laplacian, ldlt_, gains, X, optionsFor(accuracy.value), progress);
}

Evaluation FullSpectrumEvaluator::evaluateAgain(const Laplacian& laplacian, const Signals& X,
                                                const std::vector<double>& alphas, double accuracy,
                                                const Progress& progress) {
    if (ldlt_.factorizations() == 0) return evaluate(laplacian, X, alphas, {accuracy}, progress);
    return evaluateInKrylovSpaces(laplacian, ldlt_, gainsFor(alphas), X, optionsFor(accuracy),
                                  progress);
}

std::optional<Evaluation> FullSpectrumEvaluator::evaluateByProducts(const Laplacian& laplacian,
                                                                    const std::vector<Gain>& gains,
                                                                    const Signals& X,
                                                                    const Accuracy& accuracy,
                                                                    const Progress& progress) {
    const bool isRequired = solver_ == Solver::Products || lacksMemory_;
    // With a symbolic analysis at hand, factorizations cost less.
    const bool isWorthTrying = solver_ == Solver::Cheapest && ldlt_.factorizations() == 0;
    if (!isRequired && !isWorthTrying) return {};
    FullSpectrumOptions options = optionsFor(finer_ * accuracy.value);
    if (accuracy.areOthersCompared) options.accuracyOfOthers = accuracy.value;
    if (!isRequired) options.affordable = affordableProducts(laplacian.D.size(), products_ == 0);
    std::vector<FullSpectrumResult> results =
        applyFullSpectrum(laplacian, Products(laplacian, F_.cutoff()), gains, X, options, progress);
    if (results.empty()) return {};
    products_ += static_cast<int>(X.cols()) * results.front().dimension;
    Evaluation evaluation = joined(std::move(results));
    evaluation.accuracyReached = evaluation.errorEstimate <= accuracy.value;
    return evaluation;
}

}  // namespace spectral
