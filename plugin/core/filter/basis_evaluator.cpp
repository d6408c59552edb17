#include "core/filter/basis_evaluator.h"

#include <cmath>
#include <utility>

#include "core/harmonics/truncated_basis.h"

namespace spectral {

Evaluation BasisEvaluator::evaluate(const Laplacian& laplacian, const Signals& X,
                                    const std::vector<double>& alphas, const Accuracy&,
                                    const Progress& progress) {
    HarmonicBasis basis;
    double gainBeyond = 0.0;
    if (truncation_) {
        basis = truncatedBasis(laplacian, truncation_->basisSize, ldlt_, progress);
        gainBeyond = residualGain(laplacian, basis.lambda[basis.size() - 1]);
    } else {
        basis = harmonicsUpTo(F_.discontinuities().back(), laplacian, ldlt_, progress);
        gainBeyond = F_(2.0 * F_.discontinuities().back());
    }
    Evaluation evaluation;
    for (const double alpha : alphas)
        // The power of the mean gain, not the mean of the power: K steps then make one filter.
        evaluation.Y.push_back(applyInBasis(basis, laplacian, fractionalPower(F_, alpha),
                                            std::pow(gainBeyond, alpha), X));
    basis.Phi = {};
    basis_ = std::move(basis);
    ++computedBases_;
    return evaluation;
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
