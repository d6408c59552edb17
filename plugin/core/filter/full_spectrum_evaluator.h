#pragma once

#include <map>
#include <optional>
#include <vector>

#include "core/filter/evaluator.h"
#include "core/krylov/full_spectrum.h"
#include "core/krylov/pole_selection.h"
#include "core/transfer/transfer_function.h"

namespace spectral {

/// Gains over all n harmonics from the Krylov spaces of one factor (full_spectrum.h).
/// @param ldlt     factorization of W + lambda_p D.
/// @param gains    continuous, at least where X has harmonics.
/// @param options  without what this function knows: round-off.
Evaluation evaluateInKrylovSpaces(const Laplacian& laplacian, const ConstantModes& constants,
                                  const ShiftedLdlt& ldlt, const std::vector<Gain>& gains,
                                  const Eigen::MatrixXd& X, FullSpectrumOptions options,
                                  const Progress& progress);

/// Evaluates over all n harmonics, by a rational Krylov method that computes none of them
/// (full_spectrum.h): for a continuous F.
class FullSpectrumEvaluator : public Evaluator {
  public:
    /// @param F  kept by reference.
    /// @param accuracy  of the whole filter, which the poles are chosen for.
    /// @param atEveryVertex  whether the accuracy is that of every vertex, or over the surface.
    FullSpectrumEvaluator(const TransferFunction& F, double accuracy, bool atEveryVertex)
        : F_(F), accuracy_(accuracy), atEveryVertex_(atEveryVertex) {}

    Evaluation evaluate(const Laplacian& laplacian, const ConstantModes& constants,
                        const Eigen::MatrixXd& X, const std::vector<double>& alphas,
                        double accuracy, const Progress& progress) override;

  private:
    double poleFor(const Laplacian& laplacian, double alpha);

    const TransferFunction& F_;
    double accuracy_;
    bool atEveryVertex_;
    std::optional<SpectrumRange> spectrum_;  // of the first Laplacian
    std::map<double, double> poles_;         // for the powers asked for so far
};

}  // namespace spectral
