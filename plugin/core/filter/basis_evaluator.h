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
///
/// After its first step a truncated filter that keeps the residual needs no basis: to X it is one
/// gain over all n harmonics, which jumps from F to F_h at the k-th. Only the harmonics near the
/// jump are computed anew, all of them by inertia, and filtered exactly. The rest of X has nothing
/// near the jump: a Krylov method resolves it (full_spectrum.h), to the accuracy asked for.
class BasisEvaluator : public Evaluator {
  public:
    /// @param F  kept by reference.
    /// @param truncation  empty: the harmonics up to the last jump of F, which must have one.
    /// @param atEveryVertex  whether the accuracy is that of every vertex, or over the surface.
    BasisEvaluator(const TransferFunction& F, std::optional<TruncationOptions> truncation,
                   bool atEveryVertex)
        : F_(F), truncation_(truncation), atEveryVertex_(atEveryVertex) {}

    Evaluation evaluate(const Laplacian& laplacian, const Eigen::MatrixXd& X,
                        const std::vector<double>& alphas, double accuracy,
                        const Progress& progress) override;

  private:
    /// Empty where it cannot be done: the accuracy is not reached (needles, say), the harmonics
    /// near the cut are one cluster or almost all that there are, or memory is short.
    std::optional<Evaluation> aroundTheCut(const Laplacian& laplacian, const Eigen::MatrixXd& X,
                                           const std::vector<double>& alphas, double accuracy,
                                           const Progress& progress);
    double residualGain(const Laplacian& laplacian, double lastEigenvalue) const;

    const TransferFunction& F_;
    std::optional<TruncationOptions> truncation_;
    bool atEveryVertex_;
    bool canDoWithoutBasis_ = false;
};

}  // namespace spectral
