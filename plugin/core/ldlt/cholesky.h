#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/laplacian/laplacian.h"
#include "core/ldlt/shifted_ldlt.h"
#include "core/support/types.h"

namespace spectral {

/// Sparse Cholesky factorization (square-root free, LDL^T) of the positive definite W + s D, s > 0;
/// counts its own work.
class ShiftedCholesky {
  public:
    /// @param shift  s > 0, in units of lambda (1 / length^2).
    /// @throws SolverFailure  when W + s D is not positive definite to working precision.
    void factorize(const Laplacian& laplacian, double shift);

    /// (W + s D)^-1 B for every column of B (n x c).
    Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const { return ldlt_.solve(B); }

    /// The same in place and in the factor's order; see ShiftedLdlt.
    void solveOrdered(double* Y, int columns) const { ldlt_.solveOrdered(Y, columns); }
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

    /// A factor of none yet that shares the symbolic analysis of W's pattern.
    ShiftedLdlt emptyFactor(const Laplacian& laplacian) {
        return ShiftedLdlt(ldlt_.analysis(laplacian));
    }

    /// Adds to the counts what has been done with another factor.
    void countWork(const ShiftedLdlt& other) {
        otherFactorizations_ += other.factorizations();
        otherSolves_ += other.solves();
    }

    double shift() const { return shift_; }
    int factorizations() const { return ldlt_.factorizations() + otherFactorizations_; }
    int solves() const { return ldlt_.solves() + otherSolves_; }  ///< Columns solved for.

  private:
    ShiftedLdlt ldlt_;
    double shift_ = 0.0;
    int otherFactorizations_ = 0, otherSolves_ = 0;
};

}  // namespace spectral
