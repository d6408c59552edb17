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
///
/// After the first step, a truncated filter that keeps the residual needs no basis: it acts on X as
/// one gain over all n harmonics, which jumps from F to F_h at the k-th. Only the harmonics near
/// the jump are recomputed, their completeness verified by inertia, and filtered exactly. The rest
/// of X has no components near the jump: a Krylov method (full_spectrum.h) filters it to the
/// requested accuracy.
class BasisEvaluator : public Evaluator {
  public:
    /// @param F  kept by reference.
    /// @param truncation  empty: use the harmonics up to the last jump of F, which must have one.
    /// @param atEveryVertex  whether accuracy bounds the error of every vertex or over the surface.
    BasisEvaluator(const TransferFunction& F, std::optional<TruncationOptions> truncation,
                   bool atEveryVertex)
        : F_(F), truncation_(truncation), atEveryVertex_(atEveryVertex) {}

    Evaluation evaluate(const Laplacian& laplacian, const Signals& X,
                        const std::vector<double>& alphas, const Accuracy& accuracy,
                        const Progress& progress) override;

  private:
    /// Evaluates with the harmonics near the cut only. Empty if impossible: the accuracy is not
    /// reached (needle triangles, for example), the harmonics near the cut form one cluster or are
    /// almost all there are, or memory is short.
    std::optional<Evaluation> aroundTheCut(const Laplacian& laplacian, const Signals& X,
                                           const std::vector<double>& alphas, double accuracy,
                                           const Progress& progress);
    double residualGain(const Laplacian& laplacian, double lastEigenvalue) const;

    const TransferFunction& F_;
    std::optional<TruncationOptions> truncation_;
    bool atEveryVertex_;
    bool canDoWithoutBasis_ = false;
};

}  // namespace spectral
