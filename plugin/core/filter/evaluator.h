#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "core/harmonics/harmonic_basis.h"
#include "core/krylov/rows.h"
#include "core/laplacian/laplacian.h"
#include "core/ldlt/shifted_ldlt.h"
#include "core/support/progress.h"

namespace spectral {

/// F^alpha(sqrt(A)) X for some powers alpha.
struct Evaluation {
    std::vector<Eigen::MatrixXd> Y;  ///< One n x c matrix for each power.
    double errorEstimate = 0.0;      ///< Largest estimated error, relative to the size of X.
    bool accuracyReached = true;
};

/// The share of a step of size alpha in the accuracy of the whole filter, since the errors of steps
/// add up; limited by round-off.
inline double accuracyOfStep(double accuracy, double alpha) {
    constexpr double kFinestAccuracy = 1e-13;
    return std::max(accuracy * alpha, kFinestAccuracy);
}

/// Requested accuracy, relative to the size of X.
struct Accuracy {
    double value;
    /// Whether all powers but the middle one are only compared, or only give areas: they need not
    /// be more accurate, where products are.
    bool areOthersCompared = false;
};

/// What an evaluation took.
struct Work {
    int factorizations = 0;    ///< Sparse LDL^T factorizations.
    int solves = 0;            ///< Solves with one right-hand side.
    int products = 0;          ///< Products of the Laplacian with one column.
    bool lacksMemory = false;  ///< Whether products replaced a factorization that did not fit in
                               ///< memory: same result, but slower.
};

/// Evaluates powers of a transfer function for a sequence of Laplacians.
class Evaluator {
  public:
    virtual ~Evaluator() = default;

    /// F^alpha(sqrt(A)) X (Kovnatsky et al. 2012, Eqs. 6 to 8 and 11).
    /// @param alphas    powers, descending; the evaluation is tuned for the middle one.
    /// @throws InvalidOption, SolverFailure, Cancelled
    virtual Evaluation evaluate(const Laplacian& laplacian, const Signals& X,
                                const std::vector<double>& alphas, const Accuracy& accuracy,
                                const Progress& progress) = 0;

    /// The last computed basis, without its vectors; empty if none was used.
    const HarmonicBasis& basis() const { return basis_; }
    int computedBases() const { return computedBases_; }
    Work work() const { return {ldlt_.factorizations(), ldlt_.solves(), products_, lacksMemory_}; }

  protected:
    ShiftedLdlt ldlt_;
    HarmonicBasis basis_;
    int computedBases_ = 0, products_ = 0;
    bool lacksMemory_ = false;
};

}  // namespace spectral
