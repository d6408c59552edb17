#pragma once

#include <map>
#include <optional>
#include <vector>

#include "core/filter/evaluator.h"
#include "core/krylov/full_spectrum.h"
#include "core/krylov/pole_selection.h"
#include "core/transfer/transfer_function.h"

namespace spectral {

/// What Krylov spaces are made with (krylov_operator.h).
enum class Solver {
    Cheapest,       ///< Products for as long as they are expected to be cheaper, or where there is
                    ///< no memory for a factorization.
    Factorization,  ///< For tests, like the next.
    Products
};

/// Gains over all n harmonics from the Krylov spaces of one factor (full_spectrum.h).
/// @param ldlt     factorization of W + lambda_p D.
/// @param gains    continuous, at least where X has harmonics.
/// @param options  without what this function knows: round-off.
Evaluation evaluateInKrylovSpaces(const Laplacian& laplacian, const ShiftedLdlt& ldlt,
                                  const std::vector<Gain>& gains, const Eigen::MatrixXd& X,
                                  FullSpectrumOptions options, const Progress& progress);

/// Evaluates over all n harmonics, by a Krylov method that computes none of them (full_spectrum.h):
/// for a continuous F.
///
/// Products with W alone are tried first where the accuracy is that of the surface as a whole: they
/// cost a tenth of a solve, without a factorization, but may need many dimensions: where triangles
/// are needles, where F is steep, or the feature size is many edges. Once they have been expected
/// to cost more than a factorization, all later Laplacians are factorized.
class FullSpectrumEvaluator : public Evaluator {
  public:
    /// @param F  kept by reference.
    /// @param accuracy  of the whole filter, which the poles are chosen for.
    /// @param atEveryVertex  whether the accuracy is that of every vertex, or over the surface.
    FullSpectrumEvaluator(const TransferFunction& F, double accuracy, bool atEveryVertex,
                          Solver solver)
        : F_(F), accuracy_(accuracy), atEveryVertex_(atEveryVertex), solver_(solver) {}

    Evaluation evaluate(const Laplacian& laplacian, const Eigen::MatrixXd& X,
                        const std::vector<double>& alphas, double accuracy,
                        const Progress& progress) override;

  private:
    /// By products, if these are to be tried; none where a factorization is expected to pay.
    std::optional<Evaluation> evaluateByProducts(const Laplacian& laplacian,
                                                 const std::vector<Gain>& gains,
                                                 const Eigen::MatrixXd& X,
                                                 FullSpectrumOptions options,
                                                 const Progress& progress);
    double poleFor(const Laplacian& laplacian, double alpha);

    const TransferFunction& F_;
    double accuracy_;
    bool atEveryVertex_;
    Solver solver_;
    bool areDear_ = false;                   // products
    std::optional<SpectrumRange> spectrum_;  // of the first Laplacian
    SpareVectors spare_;
    std::map<double, double> poles_;  // for the powers asked for so far
};

}  // namespace spectral
