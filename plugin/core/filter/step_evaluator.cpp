#include "core/filter/step_evaluator.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <string>
#include <utility>

#include "core/filter/transfer_function.h"
#include "core/harmonics/truncated_basis.h"
#include "core/krylov/full_spectrum.h"
#include "core/laplacian/frequency.h"
#include "core/laplacian/interior.h"
#include "core/support/errors.h"

namespace spectral {

namespace {

/// More harmonics than this for a discontinuous gain are a mistake of the user's: minutes of time.
constexpr Index kMaxExactBasis = 1000;

/// Relative accuracy of a step that round-off still allows.
constexpr double kFinestAccuracy = 1e-13;

/// Relative accuracy of a signal that is next to nothing beside the shape.
constexpr double kCoarsestAccuracy = 1e-2;

/// Accuracy of a shape that only a Laplacian is taken of: so many times less than that of a result,
/// as its error matters only where the Laplacian changes; but three digits at least.
constexpr double kPredictionLeeway = 20.0, kPredictionAccuracy = 1e-3;

/// Relative error, all steps together, beyond which a result is not worth having.
constexpr double kUselessError = 0.1;

}  // namespace

StepEvaluator::StepEvaluator(const EvaluationOptions& options, const Interior& interior,
                             const TransferFunction& F)
    : options_(options), interior_(interior), F_(F), extension_(interior) {}

void StepEvaluator::setLaplacian(const Laplacian& laplacian, double alpha,
                                 const Progress& progress) {
    if (!isUsable(laplacian))
        throw SolverFailure("triangles have collapsed: a cotangent or a mass is not finite");
    if (interior_.size() == 0) return;  // nothing can move
    surface_ = &laplacian;
    if (!interior_.isWhole()) {
        progress.report(0.0, "factorizing");
        extension_.setLaplacian(laplacian);
        restricted_ = interior_.restricted(laplacian);
    }
    constants_.emplace(interior_.components(), this->laplacian().D);
    if (options_.spectrum == Spectrum::Truncated) {
        truncated(progress);
    } else if (usesBasis()) {
        basis_ = upToLastJump(progress);
        ++computedBases_;
    } else {
        progress.report(0.0, "factorizing");
        const Pole& pole = poleFor(alpha);
        resolution_ = pole.resolution;
        cholesky_.factorize(this->laplacian(), pole.shift);
    }
}

/// The pole is chosen for the spectrum of the first Laplacian: those that follow are much alike.
const Pole& StepEvaluator::poleFor(double alpha) {
    if (!spectrum_) spectrum_ = bulkSpectrum(laplacian());
    const auto [place, isNew] = poles_.try_emplace(alpha);
    if (isNew)
        place->second =
            selectPole(fractionalPower(F_, alpha), F_.cutoff(), *spectrum_, accuracyOf(alpha));
    return place->second;
}

Eigen::MatrixXd StepEvaluator::operator()(const Eigen::MatrixXd& X, double alpha,
                                          const Progress& progress) {
    return std::move(evaluate(X, {alpha}, accuracyOf(alpha), progress).front());
}

std::vector<Eigen::MatrixXd> StepEvaluator::predict(const Eigen::MatrixXd& X,
                                                    const std::vector<double>& alphas,
                                                    const Progress& progress) {
    const double error = errorEstimate_;
    const bool accuracyReached = accuracyReached_;
    std::vector<Eigen::MatrixXd> shapes = evaluate(
        X, alphas, std::min(kPredictionLeeway * options_.accuracy, kPredictionAccuracy), progress);
    errorEstimate_ = error;
    accuracyReached_ = accuracyReached;
    return shapes;
}

std::vector<Eigen::MatrixXd> StepEvaluator::evaluate(const Eigen::MatrixXd& X,
                                                     const std::vector<double>& alphas,
                                                     double accuracy, const Progress& progress) {
    if (interior_.isWhole()) return onInterior(X, 1.0, alphas, accuracy, progress);
    if (interior_.size() == 0) return std::vector<Eigen::MatrixXd>(alphas.size(), X);
    const HarmonicExtension::Rest rest = extension_.rest(X);
    std::vector<Eigen::MatrixXd> shapes =
        onInterior(rest.U, rest.relativeSize, alphas, accuracy, progress);
    for (Eigen::MatrixXd& shape : shapes)
        shape = X + interior_.extended(shape - rest.U);  // exactly X on the boundary
    return shapes;
}

/// F^alpha(sqrt(A)) U on the interior; U has this size beside the shape, to which errors are
/// relative.
std::vector<Eigen::MatrixXd> StepEvaluator::onInterior(const Eigen::MatrixXd& U,
                                                       double relativeSize,
                                                       const std::vector<double>& alphas,
                                                       double accuracy, const Progress& progress) {
    std::vector<Gain> gains;
    for (const double alpha : alphas) gains.push_back(fractionalPower(F_, alpha));
    const Eigen::VectorXd& D = laplacian().D;
    std::vector<Eigen::MatrixXd> shapes;
    if (usesBasis()) {
        for (std::size_t i = 0; i < alphas.size(); ++i) {
            // The power of the mean gain, not the mean of the power: K steps then make one filter.
            const double residualGain = std::pow(residualGain_, alphas[i]);
            shapes.push_back(applyInBasis(basis_, D, *constants_, gains[i], residualGain, U));
        }
        return shapes;
    }

    FullSpectrumOptions options;
    options.accuracy = accuracy;
    options.resolution = resolution_;
    options.atEveryVertex = options_.atEveryVertex;
    if (relativeSize < 1.0)
        options.accuracy = std::min(options.accuracy / relativeSize, kCoarsestAccuracy);
    for (FullSpectrumResult& step :
         applyFullSpectrum(D, *constants_, cholesky_, gains, U, options, progress)) {
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
        shapes.push_back(std::move(step.Y));
    }
    return shapes;
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
        basis_ = {};  // of no more use: its memory goes to the next
        basis_ = truncatedBasis(laplacian(), *constants_, options_.basisSize, cholesky_, progress);
        ++computedBases_;
    } catch (const InvalidOption& error) {
        throw InvalidOption(error.what() + std::string(remedy));
    } catch (const SolverFailure& error) {
        throw SolverFailure(error.what() + std::string(remedy));
    }
    residualGain_ = 0.0;
    if (options_.reinjectResidual) {  // Eq. 9
        const double from = std::sqrt(basis_.lambda[basis_.size() - 1]);
        const double to = std::sqrt(largestEigenvalue(laplacian()));
        // As for the steps: the power of the mean, so that parts of a filter make the whole.
        const TransferFunction whole = F_.whole();
        residualGain_ =
            std::pow(from < to ? meanGain(whole, from, to) : whole(to), F_.appliedPower());
    }
}

/// The harmonics up to the last jump of F, beyond which an ideal F is constant: exact.
HarmonicBasis StepEvaluator::upToLastJump(const Progress& progress) {
    const double last = F_.discontinuities().back();
    residualGain_ = F_(2.0 * last);
    if (isDenseQuicker(interior_.size())) return denseBasis(laplacian(), *constants_);
    const Index below = cholesky_.countEigenvaluesBelow(laplacian(), last * last);
    if (below > kMaxExactBasis)
        throw InvalidOption("response = ideal needs every harmonic up to its edge, here " +
                            std::to_string(below) + " (at most " + std::to_string(kMaxExactBasis) +
                            "): choose a larger feature_size, response = butterworth with order = "
                            "8, or spectrum = truncated with reinject_residual");
    if (below == interior_.size()) return denseBasis(laplacian(), *constants_);  // nothing to cut
    return truncatedBasis(laplacian(), *constants_, std::max<Index>(below, constants_->count() + 1),
                          cholesky_, progress);
}

}  // namespace spectral
