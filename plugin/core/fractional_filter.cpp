#include "fractional_filter.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <optional>
#include <sstream>
#include <string>

#include "cholesky.h"
#include "components.h"
#include "full_spectrum.h"
#include "harmonic_basis.h"
#include "laplacian.h"
#include "measures.h"
#include "mesh_check.h"
#include "pole_selection.h"

namespace spectral {

namespace {

/// More harmonics than this for a discontinuous gain are a mistake of the user's: minutes of time.
constexpr Index kMaxExactBasis = 1000;

/// Relative accuracy of a step that round-off still allows.
constexpr double kFinestAccuracy = 1e-13;

/// Relative error, all steps together, beyond which a result is not worth having.
constexpr double kUselessError = 0.1;

/// Up to this many vertices the dense solver computes all harmonics in about a second.
constexpr Index kDenseVertices = 600;

/// The vertices that triangles use, packed; a Laplacian has no entry for the others.
struct Surface {
    Vertices
        X;  ///< n x 3, about the middle of the bounding box: no digits lost far from the origin
    Faces F;
    std::vector<Index> vertex;  ///< Row of the input for each row of X.
};

Surface packedSurface(const Vertices& V, const Faces& F) {
    std::vector<int> packed(static_cast<std::size_t>(V.rows()), -1);
    Surface surface;
    for (Index t = 0; t < F.rows(); ++t)
        for (int c = 0; c < 3; ++c) packed[F(t, c)] = 0;
    for (Index i = 0; i < V.rows(); ++i)
        if (packed[i] == 0) {
            packed[i] = static_cast<int>(surface.vertex.size());
            surface.vertex.push_back(i);
        }
    surface.X.resize(static_cast<Index>(surface.vertex.size()), 3);
    for (Index i = 0; i < surface.X.rows(); ++i) surface.X.row(i) = V.row(surface.vertex[i]);
    const Eigen::RowVector3d middle =
        0.5 * (surface.X.colwise().maxCoeff() + surface.X.colwise().minCoeff());
    surface.X.rowwise() -= middle;
    surface.F = F.unaryExpr([&](int i) { return packed[i]; });
    return surface;
}

std::string inWords(double number) {
    std::ostringstream text;
    text << std::setprecision(2) << number;
    return text.str();
}

std::string remedyForSteepGains() {
    return ". Choose a stop_gain of 0.05 instead of 0, a lower order or a wider band, response = "
           "gaussian, fewer steps, or spectrum = truncated";
}

void checkOptions(const FilterOptions& options) {
    if (options.steps < 1)
        throw InvalidOption("steps = " + std::to_string(options.steps) +
                            ": the filter is applied in at least 1 step; 10 is a good number");
    if (!std::isfinite(options.featureSize) || options.featureSize <= 0.0)
        throw InvalidOption("feature_size = " + std::to_string(options.featureSize) +
                            ": a feature size is a length above zero, e.g. 5 % of the diagonal of "
                            "the bounding box");
    if (!(options.accuracy >= 1e-12 && options.accuracy < 1.0))
        throw InvalidOption("accuracy must lie between 1e-12 and 1");
}

/// Evaluates F^alpha(sqrt(A)) X, alpha = 1/K, for one Laplacian after another.
class StepEvaluator {
  public:
    StepEvaluator(const FilterOptions& options, const Components& components,
                  const TransferFunction& F)
        : options_(options),
          components_(components),
          F_(F),
          alpha_(1.0 / options.steps),
          gain_(fractionalPower(F, alpha_)),
          accuracy_(std::max(options.accuracy / options.steps, kFinestAccuracy)) {}

    /// Takes the Laplacian of the following evaluations.
    void setLaplacian(Laplacian laplacian, const Progress& progress) {
        laplacian_ = std::move(laplacian);
        if (!isUsable(laplacian_))
            throw SolverFailure("triangles have collapsed: a cotangent or a mass is not finite");
        constants_.emplace(components_, laplacian_.D);
        if (usesBasis()) {
            const Progress rest = progress.part(0.0, 0.9);
            basis_ = options_.spectrum == Spectrum::Truncated ? truncated(rest) : exact(rest);
        } else {
            progress.report(0.0, "factorizing");
            cholesky_.factorize(
                laplacian_, selectPole(gain_, F_.cutoff(), bulkSpectrum(laplacian_), accuracy_));
        }
    }

    Eigen::MatrixXd operator()(const Eigen::MatrixXd& X, const Progress& progress) {
        if (usesBasis())
            return applyInBasis(basis_, laplacian_.D, *constants_, gain_, residualGain_, X);
        const FullSpectrumResult step = applyFullSpectrum(laplacian_.D, *constants_, cholesky_,
                                                          gain_, X, {accuracy_}, progress);
        errorEstimate_ += step.errorEstimate;
        converged_ = converged_ && step.converged;
        if (errorEstimate_ > kUselessError)
            throw SolverFailure(
                "the transfer function is too steep for spectrum = full: the relative error is "
                "about " +
                inWords(errorEstimate_) + remedyForSteepGains());
        return step.Y;
    }

    const Laplacian& laplacian() const { return laplacian_; }
    const ShiftedCholesky& cholesky() const { return cholesky_; }
    const HarmonicBasis& basis() const { return basis_; }
    double errorEstimate() const { return errorEstimate_; }
    bool converged() const { return converged_; }

  private:
    /// A rational Krylov space approximates smooth gains; a jump needs the eigenvectors below it.
    bool usesBasis() const {
        return options_.spectrum == Spectrum::Truncated || !F_.discontinuities().empty();
    }

    HarmonicBasis truncated(const Progress& progress) {
        HarmonicBasis basis =
            truncatedBasis(laplacian_, *constants_, options_.basisSize, cholesky_, progress);
        residualGain_ = 0.0;
        if (options_.reinjectResidual) {
            // Eq. 9. The power of the mean, not the mean of the power: K steps then make one
            // filter.
            const double from = std::sqrt(basis.lambda[basis.size() - 1]);
            const double to = std::sqrt(largestEigenvalue(laplacian_));
            residualGain_ = std::pow(from < to ? meanGain(F_, from, to) : F_(to), alpha_);
        }
        return basis;
    }

    /// The harmonics up to the last jump of F, beyond which an ideal F is constant: exact.
    HarmonicBasis exact(const Progress& progress) {
        const double last = F_.discontinuities().back();
        residualGain_ = gain_(2.0 * last);
        if (components_.label.size() <= kDenseVertices) return denseBasis(laplacian_, *constants_);
        const Index below = cholesky_.countEigenvaluesBelow(laplacian_, last * last);
        if (below > kMaxExactBasis)
            throw InvalidOption(
                "response = ideal needs every harmonic up to its edge, here " +
                std::to_string(below) + " (at most " + std::to_string(kMaxExactBasis) +
                "): choose a larger feature_size, response = butterworth with order = 8, or "
                "spectrum = truncated with reinject_residual");
        return truncatedBasis(laplacian_, *constants_,
                              std::max<Index>(below, constants_->count() + 1), cholesky_, progress);
    }

    const FilterOptions& options_;
    const Components& components_;
    const TransferFunction& F_;
    double alpha_;
    Gain gain_;
    double accuracy_;  // of one step: the errors of K steps add up
    Laplacian laplacian_;
    std::optional<ConstantModes> constants_;
    ShiftedCholesky cholesky_;
    HarmonicBasis basis_;
    double residualGain_ = 0.0;
    double errorEstimate_ = 0.0;
    bool converged_ = true;
};

/// Masses of a shape whose thin parts may have shrunk to a line or a point. A mass this far below
/// the others no longer moves anything (its vertex is the harmonic mean of its neighbours), but the
/// D-inner product needs it positive.
Eigen::VectorXd flooredMass(const Vertices& X, const Faces& F) {
    constexpr double kFloor = 1e-12;
    const Eigen::VectorXd D = lumpedMass(X, F);
    return D.cwiseMax(kFloor * D.mean());
}

/// Length of every row of `displacement`, as their maximum and their D-weighted root mean square.
void measureDisplacement(const Vertices& displacement, const Eigen::VectorXd& D,
                         FilterResult& result) {
    const Eigen::VectorXd squares = displacement.rowwise().squaredNorm();
    result.maxDisplacement = std::sqrt(squares.maxCoeff());
    result.rmsDisplacement = std::sqrt(squares.dot(D) / D.sum());
}

}  // namespace

FilterResult fractionalFilter(const Vertices& V, const Faces& F, const FilterOptions& options,
                              const Progress& progress) {
    checkMesh(V, F);  // first: a feature size that is a part of an infinite diagonal is its fault
    checkOptions(options);
    const Surface surface = packedSurface(V, F);
    const TransferFunction transfer(options.transferFunction, 2.0 * kPi / options.featureSize);
    const Components components = connectedComponents(surface.F, surface.X.rows());

    StepEvaluator evaluate(options, components, transfer);
    const Eigen::VectorXd inputMass = lumpedMass(surface.X, surface.F);
    Vertices X = surface.X;
    FilterResult result;

    // Eq. 11: X_0 = X, X_(i+1) = F^(1/K)(sqrt(A(X_i))) X_i.
    for (int step = 0; step < options.steps; ++step) {
        const std::string name =
            "step " + std::to_string(step + 1) + " of " + std::to_string(options.steps) + ": ";
        const Progress stage = progress.part(static_cast<double>(step) / options.steps,
                                             (step + 1.0) / options.steps, name);
        try {
            if (step == 0 || options.basisUpdate == BasisUpdate::Full)
                evaluate.setLaplacian(cotangentLaplacian(X, surface.F), stage);
            else if (options.basisUpdate == BasisUpdate::Conformal)
                evaluate.setLaplacian({evaluate.laplacian().W, flooredMass(X, surface.F)}, stage);
            X = evaluate(X, stage);
            stage.report(1.0, "done");
        } catch (const SolverFailure& failure) {
            throw SolverFailure(
                name + failure.what() +
                (step == 0 || options.basisUpdate != BasisUpdate::Full
                     ? ""
                     : ". A strong filter with basis_update = full pinches thin "
                       "parts off: basis_update = conformal is the stabler choice"));
        }
        result.stepSizes.push_back(1.0 / options.steps);
    }
    if (!X.allFinite()) throw SolverFailure("the filtered coordinates are not finite numbers");

    // The displacement is added to the input: what does not move keeps its coordinates to the bit.
    const Vertices displacement = X - surface.X;
    result.V = V;
    for (Index i = 0; i < X.rows(); ++i) result.V.row(surface.vertex[i]) += displacement.row(i);

    result.steps = options.steps;
    result.cutoffFrequency = transfer.cutoff();
    result.featureSize = options.featureSize;
    measureDisplacement(displacement, inputMass, result);
    result.areaBefore = surfaceArea(surface.X, surface.F);
    result.areaAfter = surfaceArea(X, surface.F);
    result.volumeBefore = signedVolume(surface.X, surface.F);
    result.volumeAfter = signedVolume(X, surface.F);
    result.components = components.count;
    result.unreferencedVertices = static_cast<int>(V.rows() - X.rows());
    result.factorizations = evaluate.cholesky().factorizations();
    result.solves = evaluate.cholesky().solves();
    result.errorEstimate = evaluate.errorEstimate();
    result.accuracyReached = evaluate.converged();
    if (!result.accuracyReached)
        result.warnings.push_back("the requested relative accuracy of " +
                                  inWords(options.accuracy) +
                                  " was not reached, the estimated error is " +
                                  inWords(result.errorEstimate) + remedyForSteepGains());
    result.eigenvalues = evaluate.basis().lambda;
    return result;
}

}  // namespace spectral
