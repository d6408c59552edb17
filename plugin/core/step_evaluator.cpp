#include "step_evaluator.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <string>
#include <utility>

#include "basis_update.h"
#include "errors.h"
#include "full_spectrum.h"
#include "leak_correction.h"
#include "pole_selection.h"

namespace spectral {

namespace {

/// More harmonics than this for a discontinuous gain are a mistake of the user's: minutes of time.
constexpr Index kMaxExactBasis = 1000;

/// The update of a basis costs k^2 n, the computation of one k n: beyond this size the latter is
/// the quicker one.
constexpr Index kMaxUpdatedBasis = 600;

/// Relative accuracy of a step that round-off still allows.
constexpr double kFinestAccuracy = 1e-13;

/// Relative accuracy of a signal that is next to nothing beside the shape.
constexpr double kCoarsestAccuracy = 1e-2;

/// Relative error, all steps together, beyond which a result is not worth having.
constexpr double kUselessError = 0.1;

}  // namespace

StepEvaluator::StepEvaluator(const EvaluationOptions& options, const Interior& interior,
                             const TransferFunction& F)
    : options_(options), interior_(interior), F_(F), extension_(interior) {}

void StepEvaluator::setLaplacian(Laplacian laplacian, double alpha, const Progress& progress) {
    if (!isUsable(laplacian))
        throw SolverFailure("triangles have collapsed: a cotangent or a mass is not finite");
    if (interior_.size() == 0) return;  // nothing can move
    if (interior_.isWhole()) {
        laplacian_ = std::move(laplacian);
    } else {
        progress.report(0.0, "factorizing");
        extension_.setLaplacian(laplacian);
        laplacian_ = interior_.restricted(laplacian);
    }
    constants_.emplace(interior_.components(), laplacian_.D);
    if (options_.spectrum == Spectrum::Truncated) {
        truncated(progress);
    } else if (usesBasis()) {
        basis_ = upToLastJump(progress);
        ++computedBases_;
    } else {
        progress.report(0.0, "factorizing");
        cholesky_.factorize(laplacian_, selectPole(fractionalPower(F_, alpha), F_.cutoff(),
                                                   bulkSpectrum(laplacian_), accuracyOf(alpha)));
    }
}

Eigen::MatrixXd StepEvaluator::operator()(const Eigen::MatrixXd& X, double alpha,
                                          const Progress& progress) {
    if (interior_.isWhole()) return onInterior(X, 1.0, alpha, progress);
    if (interior_.size() == 0) return X;
    const HarmonicExtension::Rest rest = extension_.rest(X);
    const Eigen::MatrixXd filtered = onInterior(rest.U, rest.relativeSize, alpha, progress);
    return X + interior_.extended(filtered - rest.U);  // exactly X on the boundary
}

/// F^alpha(sqrt(A)) U on the interior; U has this size beside the shape, to which errors are
/// relative.
Eigen::MatrixXd StepEvaluator::onInterior(const Eigen::MatrixXd& U, double relativeSize,
                                          double alpha, const Progress& progress) {
    const Gain gain = fractionalPower(F_, alpha);
    // The power of the mean gain, not the mean of the power: K steps then make one filter.
    const double residualGain = std::pow(residualGain_, alpha);
    if (basis_.leak)
        return applyInLeakingBasis(basis_, laplacian_.D, *constants_, gain, residualGain, U,
                                   factors_.front(), progress);
    if (usesBasis()) return applyInBasis(basis_, laplacian_.D, *constants_, gain, residualGain, U);

    FullSpectrumOptions options;
    options.accuracy = accuracyOf(alpha);
    if (relativeSize < 1.0)
        options.accuracy = std::min(options.accuracy / relativeSize, kCoarsestAccuracy);
    const FullSpectrumResult step =
        applyFullSpectrum(laplacian_.D, *constants_, cholesky_, gain, U, options, progress);
    const double error = errorEstimate_ + relativeSize * step.errorEstimate;
    if (error > kUselessError) {
        std::ostringstream text;
        text << "the transfer function is too steep for spectrum = full: the relative error is "
                "about "
             << std::setprecision(2) << error
             << ". Choose a stop_gain of 0.05 instead of 0, a lower order or a wider band, "
                "response = gaussian, fewer steps, or spectrum = truncated";
        throw SolverFailure(text.str());
    }
    errorEstimate_ = error;  // only now: a failed step is tried again in smaller ones
    accuracyReached_ = accuracyReached_ && step.converged;
    return step.Y;
}

void StepEvaluator::forgetErrors() {
    errorEstimate_ = 0.0;
    accuracyReached_ = true;
}

/// A rational Krylov space approximates smooth gains; a jump needs the eigenvectors below it.
bool StepEvaluator::usesBasis() const {
    return options_.spectrum == Spectrum::Truncated || !F_.discontinuities().empty();
}

/// The errors of the steps add up to the requested one: each has its share.
double StepEvaluator::accuracyOf(double alpha) const {
    return std::max(options_.accuracy * alpha, kFinestAccuracy);
}

void StepEvaluator::truncated(const Progress& progress) {
    if (!interior_.isWhole() && options_.basisSize >= interior_.size())
        throw InvalidOption("basis_size = " + std::to_string(options_.basisSize) +
                            " needs more vertices than the " + std::to_string(interior_.size()) +
                            " that a fixed boundary leaves: choose a smaller basis_size, "
                            "spectrum = full, or boundary = free");
    // The basis knows of no filter; what else a filter offers is said here.
    const char* const remedy = ", or spectrum = full";
    try {
        followBasis(progress);
    } catch (const InvalidOption& error) {
        throw InvalidOption(error.what() + std::string(remedy));
    } catch (const SolverFailure& error) {
        throw SolverFailure(error.what() + std::string(remedy));
    }
    residualGain_ = 0.0;
    if (options_.reinjectResidual) {  // Eq. 9
        const double from = std::sqrt(basis_.lambda[basis_.size() - 1]);
        const double to = std::sqrt(largestEigenvalue(laplacian_));
        // As for the steps: the power of the mean, so that parts of a filter make the whole.
        const TransferFunction whole = F_.whole();
        residualGain_ =
            std::pow(from < to ? meanGain(whole, from, to) : whole(to), F_.appliedPower());
    }
}

/// The basis of the present Laplacian: of the last one's, where that is near enough.
void StepEvaluator::followBasis(const Progress& progress) {
    const Index k = options_.basisSize;
    if (k <= kMaxUpdatedBasis && basis_.size() > 0) {
        const BasisUpdateResult update = updateBasis(laplacian_, *constants_, k, UpdateGate(),
                                                     basis_, factors_, progress.part(0.0, 0.5));
        cholesky_.countWork(update.factorizations, update.solves);
        if (update.accepted) {
            ++updatedBases_;
            return;
        }
    }
    basis_ = {};  // of no more use: its memory goes to the next
    basis_ = truncatedBasis(laplacian_, *constants_, k, cholesky_, factors_, progress);
    ++computedBases_;
}

/// The harmonics up to the last jump of F, beyond which an ideal F is constant: exact.
HarmonicBasis StepEvaluator::upToLastJump(const Progress& progress) {
    const double last = F_.discontinuities().back();
    residualGain_ = F_(2.0 * last);
    if (isDenseQuicker(interior_.size())) return denseBasis(laplacian_, *constants_);
    const Index below = cholesky_.countEigenvaluesBelow(laplacian_, last * last);
    if (below > kMaxExactBasis)
        throw InvalidOption("response = ideal needs every harmonic up to its edge, here " +
                            std::to_string(below) + " (at most " + std::to_string(kMaxExactBasis) +
                            "): choose a larger feature_size, response = butterworth with order = "
                            "8, or spectrum = truncated with reinject_residual");
    if (below == interior_.size()) return denseBasis(laplacian_, *constants_);  // nothing to cut
    return truncatedBasis(laplacian_, *constants_, std::max<Index>(below, constants_->count() + 1),
                          cholesky_, factors_, progress);
}

}  // namespace spectral
