#include "core/filter/basis_evaluator.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/filter/full_spectrum_evaluator.h"
#include "core/harmonics/truncated_basis.h"
#include "core/support/errors.h"
#include "core/support/memory.h"

namespace spectral {

namespace {

/// After the first step, k / kNearTheCut harmonics are computed on each side of the cut: more would
/// take longer than the solves they save (bench_steps truncated).
constexpr Index kNearTheCut = 5;

/// Smallest basis for which this is faster than recomputing all harmonics (bench_steps truncated).
constexpr Index kMinHarmonics = 200;

}  // namespace

Evaluation BasisEvaluator::evaluate(const Laplacian& laplacian, const Signals& X,
                                    const std::vector<double>& alphas, const Accuracy& accuracy,
                                    const Progress& progress) {
    double done = 0.0;
    if (canDoWithoutBasis_) {
        done = 0.9;
        std::optional<Evaluation> evaluation =
            aroundTheCut(laplacian, X, alphas, accuracy.value, progress.part(0.0, done));
        if (evaluation) return *std::move(evaluation);
        canDoWithoutBasis_ = false;  // later steps would fail, too
    }
    const Progress remaining = progress.part(done, 1.0);
    HarmonicBasis basis;
    double gainBeyond = 0.0;
    if (truncation_) {
        basis = truncatedBasis(laplacian, truncation_->basisSize, ldlt_, remaining);
        gainBeyond = residualGain(laplacian, basis.lambda[basis.size() - 1]);
    } else {
        basis = harmonicsUpTo(F_.discontinuities().back(), laplacian, ldlt_, remaining);
        gainBeyond = F_(2.0 * F_.discontinuities().back());
    }
    Evaluation evaluation;
    for (const double alpha : alphas)
        // The power of the mean gain, not the mean of the power: K steps then make one filter.
        evaluation.Y.push_back(applyInBasis(basis, laplacian, fractionalPower(F_, alpha),
                                            std::pow(gainBeyond, alpha), X));
    basis.Phi = {};
    basis_ = std::move(basis);
    if (computedBases_++ == 0)
        // If the residual is dropped, the jump is so large that a basis is no slower.
        canDoWithoutBasis_ = truncation_ && truncation_->reinjectResidual &&
                             truncation_->basisSize >= kMinHarmonics &&
                             F_.discontinuities().empty();
    return evaluation;
}

std::optional<Evaluation> BasisEvaluator::aroundTheCut(const Laplacian& laplacian, const Signals& X,
                                                       const std::vector<double>& alphas,
                                                       double accuracy, const Progress& progress) {
    const Index k = truncation_->basisSize, margin = k / kNearTheCut, n = laplacian.D.size();
    if (k - margin <= laplacian.constants.count() || k + margin >= n) return {};
    FullSpectrumOptions options;
    options.accuracy = accuracy;
    options.atEveryVertex = atEveryVertex_;
    options.samples = F_.samples();
    // A Krylov space of maximum dimension may need more memory than the basis did.
    const double numbers =
        static_cast<double>(options.maxDimension) * static_cast<double>(X.size());
    if (sizeof(double) * numbers > availableMemory()) return {};
    try {
        const HarmonicBasis near =
            harmonicsBetween(laplacian, k - margin, k + margin, ldlt_, progress.part(0.0, 0.6));
        const std::optional<Index> size = cutOutsideClusters(near.lambda, k, near.first);
        if (!size) return {};
        const Index inside = *size - near.first;
        const double below = near.lambda[inside - 1], above = near.lambda[inside];
        const double cut = std::sqrt(0.5 * (below + above)),
                     gainBeyond = residualGain(laplacian, below);
        // Kovnatsky et al. 2012, Eqs. 6 to 10: F on the first harmonics, F_h on all others.
        std::vector<Gain> gains;
        for (const double alpha : alphas)
            gains.push_back([F = fractionalPower(F_, alpha), Fh = std::pow(gainBeyond, alpha),
                             cut](double omega) { return omega < cut ? F(omega) : Fh; });

        const Eigen::MatrixXd c = near.transform(laplacian.D, X);
        const Eigen::ArrayXd omega = near.lambda.cwiseSqrt();
        options.samples.insert(options.samples.end(), {omega[0], omega[omega.size() - 1]});
        // A pole at the cut makes both sides of the spectrum equally large.
        ldlt_.factorizeDefinite(laplacian.W, laplacian.D, cut * cut,
                                [&] { progress.report(0.6, "factorizing"); });
        Evaluation evaluation =
            evaluateInKrylovSpaces(laplacian, ldlt_, gains, X - near.inverseTransform(c),
                                   std::move(options), progress.part(0.6, 1.0));
        if (!evaluation.accuracyReached) return {};
        for (std::size_t i = 0; i < gains.size(); ++i)
            evaluation.Y[i] +=
                near.inverseTransform(omega.unaryExpr(gains[i]).matrix().asDiagonal() * c);
        return evaluation;
    } catch (const SolverFailure&) {
        return {};
    }
}

/// F_h: the mean of F over the frequencies beyond the basis (Kovnatsky et al. 2012, Eq. 9) if the
/// residual is reinjected (Eq. 8); 0 if it is dropped (Eq. 6).
double BasisEvaluator::residualGain(const Laplacian& laplacian, double lastEigenvalue) const {
    if (!truncation_->reinjectResidual) return 0.0;
    const double from = std::sqrt(lastEigenvalue);
    const double to = std::sqrt(largestEigenvalue(laplacian));
    // Again the power of the mean: fractional parts then compose to the whole filter.
    const TransferFunction whole = F_.whole();
    return std::pow(from < to ? meanGain(whole, from, to) : whole(to), F_.appliedPower());
}

}  // namespace spectral
