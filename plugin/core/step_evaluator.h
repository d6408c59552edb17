#pragma once

#include <optional>

#include "cholesky.h"
#include "components.h"
#include "harmonic_basis.h"
#include "laplacian.h"
#include "progress.h"
#include "transfer_function.h"

namespace spectral {

/// How F(sqrt(A)) X is evaluated.
enum class Spectrum {
    Full,      ///< All n harmonics, by a rational Krylov method that computes none of them.
    Truncated  ///< The k lowest harmonics, and one gain for the rest.
};

struct EvaluationOptions {
    Spectrum spectrum = Spectrum::Full;
    int basisSize = 300;           ///< k, for Spectrum::Truncated: below the number of vertices.
    bool reinjectResidual = true;  ///< For Spectrum::Truncated: keep what is beyond k (Eq. 8).
    double accuracy = 1e-6;        ///< For Spectrum::Full: error of all steps together, relative to
                                   ///< the shape's own size (see full_spectrum.h).
};

/// Evaluates fractional steps F^alpha(sqrt(A)) X (Eq. 11), for one Laplacian A after another.
class StepEvaluator {
  public:
    /// The arguments are kept by reference.
    StepEvaluator(const EvaluationOptions& options, const Components& components,
                  const TransferFunction& F);

    /// Takes the Laplacian of the evaluations to come, and makes of it what they need: a
    /// factorization, or a basis.
    /// @param alpha  fractional power that the evaluations will mostly have.
    /// @throws SolverFailure  when triangles have collapsed so far that this is impossible.
    void setLaplacian(Laplacian laplacian, double alpha, const Progress& progress);

    /// @throws SolverFailure  when F^alpha is too steep to be evaluated at all.
    Eigen::MatrixXd operator()(const Eigen::MatrixXd& X, double alpha, const Progress& progress);

    const Laplacian& laplacian() const { return laplacian_; }
    const HarmonicBasis& basis() const { return basis_; }  ///< Empty where none is used.
    int factorizations() const { return cholesky_.factorizations(); }
    int solves() const { return cholesky_.solves(); }

    /// Counts errorEstimate and accuracyReached anew from here on, for another way from the start.
    void forgetErrors();
    double errorEstimate() const { return errorEstimate_; }  ///< Relative, of all evaluations.
    bool accuracyReached() const { return accuracyReached_; }

  private:
    bool usesBasis() const;
    double accuracyOf(double alpha) const;
    HarmonicBasis truncated(const Progress& progress);
    HarmonicBasis upToLastJump(const Progress& progress);

    const EvaluationOptions& options_;
    const Components& components_;
    const TransferFunction& F_;
    Laplacian laplacian_;
    std::optional<ConstantModes> constants_;
    ShiftedCholesky cholesky_;
    HarmonicBasis basis_;
    double residualGain_ = 0.0;  // F's mean for what is beyond the basis
    double errorEstimate_ = 0.0;
    bool accuracyReached_ = true;
};

}  // namespace spectral
