#pragma once

#include <Eigen/Core>
#include <memory>
#include <utility>
#include <vector>

#include "core/ldlt/ldlt_elimination.h"
#include "core/ldlt/symbolic_ldlt.h"
#include "core/support/types.h"

namespace spectral {

/// LDL^T factorization of W - sigma D for a symmetric W, a positive diagonal D and any shift: below
/// the spectrum of W x = lambda D x, where the matrix is positive definite, or inside it, where it
/// is indefinite.
///
/// Solves linear systems and counts eigenvalues by the signs of the pivots (Sylvester's law of
/// inertia). All factorizations of matrices with the same pattern share the fill-reducing order and
/// the symbolic analysis.
class ShiftedLdlt {
  public:
    /// Factorizes W - sigma D.
    /// @param W      n x n, symmetric, both triangles stored.
    /// @param D      n diagonal entries > 0.
    /// @param sigma  the shift, perturbed by a relative 1e-7 if a pivot vanishes; see shift().
    /// @param stop   called now and then on the caller's thread; may throw.
    /// @throws Error  with code OutOfMemory, when the factor needs more memory than is free.
    /// @throws SolverFailure  when pivots vanish or are not finite at all nearby shifts tried, or
    ///                        the factor has more entries than an int can count: some 1e7 rows.
    void factorize(const SparseMatrix& W, const Eigen::VectorXd& D, double sigma,
                   const StopPoint& stop = {});

    /// Factorizes W + shift D.
    /// @throws SolverFailure  also when it is not positive definite to working precision.
    void factorizeDefinite(const SparseMatrix& W, const Eigen::VectorXd& D, double shift,
                           const StopPoint& stop = {});

    double shift() const { return shift_; }  ///< sigma of the factorized W - sigma D.

    /// Number of eigenvalues of W x = lambda D x below shift(), exactly: the number of negative
    /// pivots.
    Index eigenvaluesBelow() const { return below_; }

    /// (W - sigma D)^-1 B for every column of B (n x c).
    Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const;

    /// U <- (W - sigma D)^-1 D U for each column of U (n x c, contiguous): the resolvent of D^-1 W
    /// at sigma.
    /// @param D  n masses, or a multiple of them.
    void applyResolvent(const Eigen::VectorXd& D, Eigen::Ref<Eigen::MatrixXd> U) const;

    /// The factor's own order: row i of W is row factorOrder()[i] of the factor, and row j of the
    /// factor is row inverseOrder()[j] of W.
    const Eigen::VectorXi& factorOrder() const { return symbolic_->order; }
    const std::vector<int>& inverseOrder() const { return symbolic_->inverse; }

    /// Rows of the vectors passed to solveOrdered: n, and some copies for its own use.
    Index orderedRows() const {
        return symbolic_->order.size() + static_cast<Index>(symbolic_->copied.size());
    }

    /// (W - sigma D)^-1 Y, in place and in the factor's order, on the threads of the caller's team.
    /// @param Y  orderedRows() rows of `columns` numbers each, contiguous; rows from n on are
    ///           scratch.
    /// @param columns  1 to 4, or kMaxRightHandSides.
    void solveOrdered(double* Y, int columns) const;

    /// A new, empty factorization that shares the symbolic analysis of W's pattern.
    ShiftedLdlt sibling(const SparseMatrix& W);

    /// Adds the work of a sibling to the counts below.
    void addWork(const ShiftedLdlt& sibling) {
        factorizations_ += sibling.factorizations_;
        solves_ += sibling.solves_;
    }
    int factorizations() const { return factorizations_; }
    int solves() const { return solves_; }  ///< Number of right-hand sides.

  private:
    void analyze(const SparseMatrix& W, const SymbolicLdlt* similar);

    std::shared_ptr<const SymbolicLdlt> analysis_;  // analysis of the latest pattern
    std::shared_ptr<const SymbolicLdlt> symbolic_;  // analysis of the current factor
    LdltNumbers numbers_;
    double shift_ = 0.0;
    Index below_ = 0;
    int factorizations_ = 0;
    mutable int solves_ = 0;
};

/// Exact number of eigenvalues of W x = lambda D x below sigma, which must not be an eigenvalue.
/// @param ldlt  provides the symbolic analysis and counts the work; its factor is kept.
/// @throws SolverFailure  as ShiftedLdlt::factorize.
Index countEigenvaluesBelow(const SparseMatrix& W, const Eigen::VectorXd& D, double sigma,
                            ShiftedLdlt& ldlt);

}  // namespace spectral
