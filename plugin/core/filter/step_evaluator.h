#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "core/filter/basis_evaluator.h"
#include "core/filter/evaluator.h"
#include "core/filter/full_spectrum_evaluator.h"
#include "core/laplacian/harmonic_extension.h"
#include "core/laplacian/interior.h"
#include "core/laplacian/laplacian.h"
#include "core/support/progress.h"
#include "core/transfer/transfer_function.h"

namespace spectral {

/// How F(sqrt(A)) X is evaluated.
enum class Spectrum {
    Full,      ///< All n harmonics, by a rational Krylov method that computes none of them.
    Truncated  ///< The k lowest harmonics, with a single gain for the rest.
};

struct EvaluationOptions {
    Spectrum spectrum = Spectrum::Full;
    TruncationOptions truncation;  ///< For Spectrum::Truncated.

    /// Maximum error of all steps together, relative to the size of the shape (FullSpectrumResult),
    /// if they are evaluated without a basis.
    double accuracy = 1e-6;
    double finerByProducts = 1.0;  ///< Factor on it where products suffice, <= 1: there, an error a
                                   ///< hundredth as large takes half as much time again.
    /// Whether the accuracy bounds the error of every vertex or that over the surface.
    bool atEveryVertex = true;
    Solver solver = Solver::Cheapest;  ///< For Spectrum::Full.
};

/// Evaluates fractional steps F^alpha(sqrt(A)) X (Eq. 11) on a surface.
///
/// With a fixed boundary a step is H + F^alpha(sqrt(A_II)) (X - H), where H is the harmonic
/// extension of the boundary positions (harmonic_extension.h).
class StepEvaluator {
  public:
    /// The arguments are kept by reference.
    StepEvaluator(const EvaluationOptions& options, const Interior& interior,
                  const TransferFunction& F);

    /// Evaluates F^alpha(sqrt(A)) X.
    /// @param surface  the Laplacian of the surface.
    /// @throws SolverFailure  when collapsed triangles leave no usable Laplacian, or the result
    ///                        would be useless.
    Evaluation operator()(const Laplacian& surface, const Signals& X, double alpha,
                          const Progress& progress);

    /// The same for several powers, with at least three digits: for shapes that only provide
    /// Laplacians and do not enter the result themselves.
    /// @param alphas  the first is half of a step, or the whole filter.
    /// @param areOthersCompared  see Accuracy.
    Evaluation predict(const Laplacian& surface, const Signals& X,
                       const std::vector<double>& alphas, const Progress& progress,
                       bool areOthersCompared = false);

    const HarmonicBasis& basis() const { return evaluator_->basis(); }  ///< Empty if none was used.
    int computedBases() const { return evaluator_->computedBases(); }
    /// Of all steps so far.
    Work work() const {
        Work all = evaluator_->work();
        all.factorizations += extension_.factorizations();
        all.solves += extension_.solves();
        return all;
    }

  private:
    Evaluation evaluate(const Laplacian& surface, const Signals& X,
                        const std::vector<double>& alphas, Accuracy accuracy,
                        const Progress& progress);

    double accuracy_;
    const Interior& interior_;
    HarmonicExtension extension_;
    std::unique_ptr<Evaluator> evaluator_;
};

/// Rejects a relative error, of one or several steps, that makes the result useless.
/// @throws SolverFailure  with code TooSteep.
void requireUsefulAccuracy(double errorEstimate);

}  // namespace spectral
