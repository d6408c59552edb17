#pragma once

#include <Eigen/SparseCholesky>

#include "laplacian.h"
#include "types.h"

namespace spectral {

/// Sparse Cholesky factorization of W + s D, s > 0, with blocked solves; counts its own work.
///
/// The fill-reducing order and the symbolic analysis are made once for each pattern of W: a
/// filter's steps change the numbers, not the connectivity.
class ShiftedCholesky {
  public:
    /// @param shift  s > 0, in units of lambda (1 / length^2).
    /// @throws SolverFailure  when W + s D is not positive definite to working precision.
    void factorize(const Laplacian& laplacian, double shift);

    /// (W + s D)^-1 B for every column of B (n x c).
    Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const;

    /// Number of eigenvalues of W phi = lambda D phi below sigma, exactly: the number of negative
    /// pivots of the LDL^T factorization of W - sigma D (Sylvester's law of inertia). Leaves the
    /// Cholesky factor as it is.
    ///
    /// @param sigma  in units of lambda; must not be an eigenvalue.
    /// @throws SolverFailure  when a pivot vanishes, i.e. sigma is too near an eigenvalue.
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
    template <int Columns>
    void solveColumns(const Eigen::MatrixXd& B, Index first, Eigen::MatrixXd& X) const;

    Eigen::SimplicialLLT<SparseMatrix, Eigen::Lower, Eigen::AMDOrdering<int>> llt_;
    SparseMatrix analyzed_;  // the last factorized matrix, for its pattern
    double shift_ = 0.0;
    int factorizations_ = 0;
    mutable int solves_ = 0;
};

}  // namespace spectral
