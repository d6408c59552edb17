#include "core/filter/basis_evaluator.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/harmonics/truncated_basis.h"
#include "core/support/errors.h"

namespace spectral {

namespace {

/// More harmonics than this for a discontinuous gain take minutes: almost certainly unintended.
constexpr Index kMaxExactBasis = 1000;

/// Error of dense eigenvalues relative to the largest, and what is tolerable relative to the one at
/// an edge, below which an eigenvalue belongs or not.
constexpr double kDenseError = 1e-15, kEdgeAccuracy = 1e-6;

}  // namespace

Evaluation BasisEvaluator::evaluate(const Laplacian& laplacian, const ConstantModes& constants,
                                    const Eigen::MatrixXd& X, const std::vector<double>& alphas,
                                    double, const Progress& progress) {
    basis_ = {};  // frees its memory before the next one is computed
    double residualGain = 0.0;
    if (truncation_) {
        basis_ = truncatedBasis(laplacian, constants, truncation_->basisSize, ldlt_, progress);
        if (truncation_->reinjectResidual) residualGain = meanResidualGain(laplacian);
    } else {
        basis_ = upToLastJump(laplacian, constants, progress);
        residualGain = F_(2.0 * F_.discontinuities().back());
    }
    ++computedBases_;
    Evaluation evaluation;
    for (const double alpha : alphas)
        // The power of the mean gain, not the mean of the power: K steps then make one filter.
        evaluation.Y.push_back(applyInBasis(basis_, laplacian.D, constants,
                                            fractionalPower(F_, alpha),
                                            std::pow(residualGain, alpha), X));
    return evaluation;
}

/// F_h (Kovnatsky et al. 2012, Eq. 9): the mean of F over the frequencies beyond the basis.
double BasisEvaluator::meanResidualGain(const Laplacian& laplacian) const {
    const double from = std::sqrt(basis_.lambda[basis_.size() - 1]);
    const double to = std::sqrt(largestEigenvalue(laplacian));
    // The power of the mean here, too, so that parts of a filter make the whole.
    const TransferFunction whole = F_.whole();
    return std::pow(from < to ? meanGain(whole, from, to) : whole(to), F_.appliedPower());
}

HarmonicBasis BasisEvaluator::upToLastJump(const Laplacian& laplacian,
                                           const ConstantModes& constants,
                                           const Progress& progress) {
    const double last = F_.discontinuities().back();
    const Index n = laplacian.D.size();
    if (isDenseQuicker(n)) {
        HarmonicBasis all = denseBasis(laplacian, constants);
        if (all.lambda[n - 1] * kDenseError > kEdgeAccuracy * last * last)
            throw SolverFailure(ErrorCode::SingularMatrix,
                                "round-off leaves nothing of the harmonics at the edge of the "
                                "filter: triangles are needles");
        return all;
    }
    const Index below = countEigenvaluesBelow(laplacian.W, laplacian.D, last * last, ldlt_);
    if (below > kMaxExactBasis)
        throw InvalidOption(ErrorCode::TooManyHarmonics,
                            "response = ideal needs every harmonic up to its edge, here " +
                                std::to_string(below) + " (at most " +
                                std::to_string(kMaxExactBasis) + ")",
                            kMaxExactBasis);
    if (below == n) return denseBasis(laplacian, constants);  // nothing to cut
    return truncatedBasis(laplacian, constants, std::max<Index>(below, constants.count() + 1),
                          ldlt_, progress);
}

}  // namespace spectral
