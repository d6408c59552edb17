#include "core/filter/full_spectrum_evaluator.h"

#include <algorithm>
#include <utility>

namespace spectral {

Evaluation evaluateInKrylovSpaces(const Laplacian& laplacian, const ConstantModes& constants,
                                  const ShiftedLdlt& ldlt, const std::vector<Gain>& gains,
                                  const Eigen::MatrixXd& X, FullSpectrumOptions options,
                                  const Progress& progress) {
    const bool hasFixedBoundary = constants.label().minCoeff() < 0;
    if (options.atEveryVertex || hasFixedBoundary)
        options.roundOffAtVertices = roundOffAtVertices(ldlt, laplacian);
    // Where a boundary is fixed, no solution is known to be free of constants.
    if (hasFixedBoundary) options.roundOff = *options.roundOffAtVertices;
    Evaluation evaluation;
    for (FullSpectrumResult& result :
         applyFullSpectrum(laplacian.D, constants, ldlt, gains, X, options, progress)) {
        evaluation.errorEstimate = std::max(evaluation.errorEstimate, result.errorEstimate);
        evaluation.accuracyReached = evaluation.accuracyReached && result.converged;
        evaluation.Y.push_back(std::move(result.Y));
    }
    return evaluation;
}

/// The pole is chosen for the spectrum of the first Laplacian: those that follow are much alike.
double FullSpectrumEvaluator::poleFor(const Laplacian& laplacian, double alpha) {
    if (!spectrum_) spectrum_ = bulkSpectrum(laplacian);
    const auto [place, isNew] = poles_.try_emplace(alpha);
    if (isNew)
        place->second = selectPole(fractionalPower(F_, alpha), F_.cutoff(), *spectrum_,
                                   accuracyOfStep(accuracy_, alpha));
    return place->second;
}

Evaluation FullSpectrumEvaluator::evaluate(const Laplacian& laplacian,
                                           const ConstantModes& constants, const Eigen::MatrixXd& X,
                                           const std::vector<double>& alphas, double accuracy,
                                           const Progress& progress) {
    const StopPoint stop = [&] { progress.report(0.0, "factorizing"); };
    stop();
    const double pole = poleFor(laplacian, alphas[alphas.size() / 2]);
    ldlt_.factorizeDefinite(laplacian.W, laplacian.D, pole, stop);

    FullSpectrumOptions options;
    options.accuracy = accuracy;
    options.atEveryVertex = atEveryVertex_;
    options.samples = F_.samples();
    std::vector<Gain> gains;
    for (const double alpha : alphas) gains.push_back(fractionalPower(F_, alpha));
    return evaluateInKrylovSpaces(laplacian, constants, ldlt_, gains, X, std::move(options),
                                  progress);
}

}  // namespace spectral
