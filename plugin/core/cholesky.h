#pragma once

#include <Eigen/Core>
#include <vector>

#include "laplacian.h"
#include "shifted_ldlt.h"
#include "types.h"

namespace spectral {

/// Sparse Cholesky factorization (square-root free, LDL^T) of the positive definite W + s D, s > 0;
/// counts its own work.
class ShiftedCholesky {
  public:
    /// @param shift  s > 0, in units of lambda (1 / length^2).
    /// @throws SolverFailure  when W + s D is not positive definite to working precision.
    void factorize(const Laplacian& laplacian, double shift);

    /// (W + s D)^-1 B for every column of B (n x c).
    Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const;

    /// The same in place and in the factor's order; see ShiftedLdlt.
    void solveOrdered(double* Y, int columns) const;
    Index orderedRows() const { return ldlt_.orderedRows(); }
    const Eigen::VectorXi& factorOrder() const { return ldlt_.factorOrder(); }
    const std::vector<int>& inverseOrder() const { return ldlt_.inverseOrder(); }

    /// Number of eigenvalues of W phi = lambda D phi below sigma, exactly: the number of negative
    /// pivots of the LDL^T factorization of W - sigma D (Sylvester's law of inertia). Leaves the
    /// Cholesky factor as it is.
    ///
    /// @param sigma  in units of lambda; must not be an eigenvalue.
    /// @throws SolverFailure  as ShiftedLdlt::factorize does.
    Index countEigenvaluesBelow(const Laplacian& laplacian, double sigma);

    /// Adds work that was done with other factors to the counts.
    void countWork(int factorizations, int solves) {
        factorizations_ += factorizations;
        solves_ += solves;
    }

    double shift() const { return shift_; }
    int factorizations() const { return factorizations_; }  ///< Of both kinds.
    int solves() const { return solves_; }                  ///< Columns solved for.

  private:
    ShiftedLdlt ldlt_;
    double shift_ = 0.0;
    int factorizations_ = 0;
    mutable int solves_ = 0;
};

}  // namespace spectral
