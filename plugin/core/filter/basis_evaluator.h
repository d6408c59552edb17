#pragma once

#include <optional>

#include "core/filter/evaluator.h"
#include "core/transfer/transfer_function.h"

namespace spectral {

/// The k lowest harmonics, and one gain for the rest.
struct TruncationOptions {
    int basisSize = 300;           ///< k, below the number of vertices.
    bool reinjectResidual = true;  ///< Keep what is beyond k (Eq. 8), else drop it (Eq. 6).
};

/// Evaluates in a basis of manifold harmonics: truncated (Kovnatsky et al. 2012, Eqs. 6 to 10), or,
/// for an F with jumps, up to the last jump, beyond which such an F is constant: exact.
class BasisEvaluator : public Evaluator {
  public:
    /// @param F  kept by reference.
    /// @param truncation  empty: the harmonics up to the last jump of F, which must have one.
    BasisEvaluator(const TransferFunction& F, std::optional<TruncationOptions> truncation)
        : F_(F), truncation_(truncation) {}

    Evaluation evaluate(const Laplacian& laplacian, const ConstantModes& constants,
                        const Eigen::MatrixXd& X, const std::vector<double>& alphas,
                        double accuracy, const Progress& progress) override;

  private:
    HarmonicBasis upToLastJump(const Laplacian& laplacian, const ConstantModes& constants,
                               const Progress& progress);
    double meanResidualGain(const Laplacian& laplacian) const;

    const TransferFunction& F_;
    std::optional<TruncationOptions> truncation_;
};

}  // namespace spectral
