#pragma once

#include <map>
#include <optional>
#include <vector>

#include "core/filter/evaluator.h"
#include "core/krylov/full_spectrum.h"
#include "core/krylov/pole_selection.h"
#include "core/transfer/transfer_function.h"

namespace spectral {

/// Operator that builds the Krylov spaces (krylov_operator.h).
enum class Solver {
    Cheapest,       ///< Products while they are expected to be cheaper, or if a factorization does
                    ///< not fit in memory.
    Factorization,  ///< Factorizations only, for tests.
    Products        ///< Products only, for tests.
};

/// Applies gains over all n harmonics in Krylov spaces of one factorization (full_spectrum.h).
/// @param ldlt     factorization of W + lambda_p D.
/// @param gains    continuous, at least where X has components.
/// @param options  all but the round-off, which is set here.
Evaluation evaluateInKrylovSpaces(const Laplacian& laplacian, const ShiftedLdlt& ldlt,
                                  const std::vector<Gain>& gains, const Signals& X,
                                  FullSpectrumOptions options, const Progress& progress);

/// Evaluates a continuous F over all n harmonics, by a Krylov method that computes none of them
/// (full_spectrum.h).
///
/// Products with W alone cost a tenth of a solve and need no factorization, but there may have to
/// be many if triangles are needles, F is steep, or the feature size spans many edges. If they cost
/// more than a factorization, this and all later Laplacians are factorized.
class FullSpectrumEvaluator : public Evaluator {
  public:
    /// @param F  kept by reference.
    /// @param accuracy  of the whole filter; the poles are chosen for it.
    /// @param atEveryVertex  whether accuracy bounds the error of every vertex or over the surface.
    /// @param finer  factor on the accuracy of products, <= 1.
    FullSpectrumEvaluator(const TransferFunction& F, double accuracy, bool atEveryVertex,
                          Solver solver, double finer = 1.0)
        : F_(F),
          accuracy_(accuracy),
          atEveryVertex_(atEveryVertex),
          solver_(solver),
          finer_(finer) {}

    Evaluation evaluate(const Laplacian& laplacian, const Signals& X,
                        const std::vector<double>& alphas, const Accuracy& accuracy,
                        const Progress& progress) override;

    /// The same on the Laplacian of the last evaluation, whose factorization serves again.
    Evaluation evaluateAgain(const Laplacian& laplacian, const Signals& X,
                             const std::vector<double>& alphas, double accuracy,
                             const Progress& progress);

  private:
    FullSpectrumOptions optionsFor(double accuracy) const;
    std::vector<Gain> gainsFor(const std::vector<double>& alphas) const;
    /// Evaluates by products; empty if a factorization is chosen or expected to be cheaper.
    std::optional<Evaluation> evaluateByProducts(const Laplacian& laplacian,
                                                 const std::vector<Gain>& gains, const Signals& X,
                                                 const Accuracy& accuracy,
                                                 const Progress& progress);
    double poleFor(const Laplacian& laplacian, double alpha);

    const TransferFunction& F_;
    double accuracy_;
    bool atEveryVertex_;
    Solver solver_;
    double finer_;
    std::optional<SpectrumRange> spectrum_;  // of the first Laplacian
    std::map<double, double> poles_;         // by power, for those requested so far
};

}  // namespace spectral
