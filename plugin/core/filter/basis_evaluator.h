#pragma once

#include <optional>

#include "core/filter/evaluator.h"
#include "core/transfer/transfer_function.h"

namespace spectral {

/// The k lowest harmonics, with a single gain for the rest.
struct TruncationOptions {
    int basisSize = 300;           ///< k, below the number of vertices.
    bool reinjectResidual = true;  ///< Keep the part beyond k (Eq. 8), or drop it (Eq. 6).
};

/// Evaluates in a basis of manifold harmonics: truncated (Kovnatsky et al. 2012, Eqs. 6 to 10), or,
/// for an F with jumps, up to the last jump. F must be constant beyond it, so this is exact.
class BasisEvaluator : public Evaluator {
  public:
    /// @param F  kept by reference.
    /// @param truncation  empty: use the harmonics up to the last jump of F, which must have one.
    BasisEvaluator(const TransferFunction& F, std::optional<TruncationOptions> truncation)
        : F_(F), truncation_(truncation) {}

    Evaluation evaluate(const Laplacian& laplacian, const Signals& X,
                        const std::vector<double>& alphas, const Accuracy& accuracy,
                        const Progress& progress) override;

  private:
    double residualGain(const Laplacian& laplacian, double lastEigenvalue) const;

    const TransferFunction& F_;
    std::optional<TruncationOptions> truncation_;
};

}  // namespace spectral
