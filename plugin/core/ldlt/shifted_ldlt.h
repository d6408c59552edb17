#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "core/laplacian/laplacian.h"
#include "core/ldlt/ldlt_elimination.h"
#include "core/ldlt/symbolic_ldlt.h"
#include "core/support/types.h"

namespace spectral {

/// LDL^T factorization of W - sigma D for any shift: below the spectrum, where the matrix is
/// positive definite, or inside it, where it is indefinite.
///
/// It serves twice: for solves, and by the signs of its pivots as a count of eigenvalues
/// (Sylvester's law of inertia). The fill-reducing order and the symbolic analysis are made once
/// for each pattern of W: shifts and a filter's steps change the numbers, not the connectivity.
class ShiftedLdlt {
  public:
    ShiftedLdlt() = default;

    /// @param analysis  of the pattern that the matrices will probably have: shared.
    explicit ShiftedLdlt(std::shared_ptr<const SymbolicLdlt> analysis)
        : analysis_(std::move(analysis)) {}

    /// @param sigma  in units of lambda (1 / length^2); moved a little when a pivot vanishes.
    /// @throws SolverFailure  when pivots vanish, or are not finite, at every shift nearby.
    /// @throws InvalidMesh  when the factor has more entries than an int counts: some 1e7 vertices.
    void factorize(const Laplacian& laplacian, double sigma);

    double shift() const { return shift_; }

    /// The symbolic analysis of W's pattern: made anew if the last one is not of it. The factor
    /// keeps its own.
    const std::shared_ptr<const SymbolicLdlt>& analysis(const Laplacian& laplacian);

    int factorizations() const { return factorizations_; }  ///< Done with this object.
    int solves() const { return solves_; }                  ///< Columns solved for.

    /// Number of eigenvalues of W phi = lambda D phi below shift(), exactly: that of the negative
    /// pivots.
    Index eigenvaluesBelow() const { return below_; }

    /// (W - sigma D)^-1 B for every column of B (n x c).
    Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const;

    /// U <- (W - sigma D)^-1 D U - root U for every column of U (n x c, without gaps): the
    /// resolvent of A = D^-1 W at sigma, or a linear factor of a polynomial in it.
    /// @param D  n masses, or a multiple of them.
    void applyResolvent(const Eigen::VectorXd& D, Eigen::Ref<Eigen::MatrixXd> U,
                        double root = 0.0) const;

    /// The factor's own order, for work that is done in it: row i of W is row factorOrder()[i], and
    /// row j of the factor is row inverseOrder()[j]. Of the last factorize().
    const Eigen::VectorXi& factorOrder() const { return symbolic_->order; }
    const std::vector<int>& inverseOrder() const { return symbolic_->inverse; }

    /// Rows of the vectors that solveOrdered works on: n, and some copies for its own use.
    Index orderedRows() const {
        return symbolic_->order.size() + static_cast<Index>(symbolic_->copied.size());
    }

    /// (W - sigma D)^-1 Y, in place and in the factor's order, on the threads of the caller's team.
    /// @param Y  orderedRows() rows of `columns` numbers each, next to each other; what is in those
    ///           from n on does not matter.
    /// @param columns  1, 2, 3, 4, 8 or kMostRightHandSides.
    void solveOrdered(double* Y, int columns) const;

  private:
    std::shared_ptr<const SymbolicLdlt> analysis_;  // the last one
    std::shared_ptr<const SymbolicLdlt> symbolic_;  // of the factor
    LdltNumbers numbers_;
    double shift_ = 0.0;
    Index below_ = 0;
    int factorizations_ = 0;
    mutable int solves_ = 0;
};

}  // namespace spectral
