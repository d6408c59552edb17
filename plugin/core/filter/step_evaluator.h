#pragma once

#include <map>
#include <optional>
#include <vector>

#include "core/filter/transfer_function.h"
#include "core/harmonics/harmonic_basis.h"
#include "core/krylov/pole_selection.h"
#include "core/laplacian/constant_modes.h"
#include "core/laplacian/harmonic_extension.h"
#include "core/laplacian/interior.h"
#include "core/laplacian/laplacian.h"
#include "core/ldlt/cholesky.h"
#include "core/support/progress.h"

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
                                   ///< the shape's own size (see full_spectrum.h),
    bool atEveryVertex = true;     ///< at every vertex or over the surface.
};

/// Evaluates fractional steps F^alpha(sqrt(A)) X (Eq. 11), for one Laplacian A after another.
///
/// With a fixed boundary a step is H + F^alpha(sqrt(A_II)) (X - H), H the harmonic extension of the
/// boundary's positions (harmonic_extension.h): all that follows is done on the interior.
class StepEvaluator {
  public:
    /// The arguments are kept by reference.
    StepEvaluator(const EvaluationOptions& options, const Interior& interior,
                  const TransferFunction& F);

    /// Takes the surface's Laplacian for the evaluations to come, and makes of it what they need: a
    /// factorization, or a basis.
    /// @param laplacian  kept by reference.
    /// @param alpha      fractional power that the evaluations will mostly have.
    /// @throws SolverFailure  when triangles have collapsed so far that this is impossible.
    void setLaplacian(const Laplacian& laplacian, double alpha, const Progress& progress);

    /// F^alpha(sqrt(A)) X.
    /// @throws SolverFailure  when F^alpha is too steep to be evaluated at all.
    Eigen::MatrixXd operator()(const Eigen::MatrixXd& X, double alpha, const Progress& progress);

    /// The same for several powers, with fewer digits: for shapes that Laplacians are taken of, and
    /// that are not in the result themselves. Their errors do not count.
    std::vector<Eigen::MatrixXd> predict(const Eigen::MatrixXd& X,
                                         const std::vector<double>& alphas,
                                         const Progress& progress);

    const HarmonicBasis& basis() const { return basis_; }  ///< Empty where none is used.
    int computedBases() const { return computedBases_; }
    int factorizations() const { return cholesky_.factorizations() + extension_.factorizations(); }
    int solves() const { return cholesky_.solves() + extension_.solves(); }

    /// Counts errorEstimate and accuracyReached anew from here on, for another way from the start.
    void forgetErrors();
    double errorEstimate() const { return errorEstimate_; }  ///< Relative, of all evaluations.
    bool accuracyReached() const { return accuracyReached_; }

  private:
    bool usesBasis() const;
    double accuracyOf(double alpha) const;
    std::vector<Eigen::MatrixXd> evaluate(const Eigen::MatrixXd& X,
                                          const std::vector<double>& alphas, double accuracy,
                                          const Progress& progress);
    std::vector<Eigen::MatrixXd> onInterior(const Eigen::MatrixXd& U, double relativeSize,
                                            const std::vector<double>& alphas, double accuracy,
                                            const Progress& progress);
    const Pole& poleFor(double alpha);
    void truncated(const Progress& progress);
    HarmonicBasis upToLastJump(const Progress& progress);
    const Laplacian& laplacian() const { return interior_.isWhole() ? *surface_ : restricted_; }

    const EvaluationOptions& options_;
    const Interior& interior_;
    const TransferFunction& F_;
    HarmonicExtension extension_;
    const Laplacian* surface_ = nullptr;
    Laplacian restricted_;  // to the interior, where that is not all of the surface
    std::optional<ConstantModes> constants_;
    std::optional<SpectrumRange> spectrum_;  // of the first Laplacian
    std::map<double, Pole> poles_;           // for the powers that have been asked for
    int resolution_ = 1;                     // of the last pole
    ShiftedCholesky cholesky_;
    HarmonicBasis basis_;
    int computedBases_ = 0;
    double residualGain_ = 0.0;  // F's mean for what is beyond the basis
    double errorEstimate_ = 0.0;
    bool accuracyReached_ = true;
};

}  // namespace spectral
