#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/laplacian/laplacian.h"
#include "core/ldlt/shifted_ldlt.h"

namespace spectral {

/// An operator S whose Krylov spaces approximate functions of A = D^-1 W: it has the eigenvectors
/// of A, and eigenvalues theta that are a monotonic function of A's lambda.
///
/// Its vectors have an order of their own, with rows of scratch behind the n of the mesh.
class KrylovOperator {
  public:
    virtual ~KrylovOperator() = default;

    /// Y <- S Q, on the threads of the caller's team.
    /// @param D  n masses; in the order of S, like all rows.
    /// @param Q  n rows of `columns` numbers each, contiguous.
    /// @param Y  rows() rows.
    /// @return   the D-inner product of each column of Q with that of Y.
    virtual Eigen::ArrayXd apply(const Eigen::VectorXd& D, const double* Q, int columns,
                                 double* Y) const = 0;

    virtual Index rows() const = 0;
    virtual const int* order() const = 0;         ///< The row of each vertex, n.
    virtual const int* inverseOrder() const = 0;  ///< The vertex of each row, n.

    virtual double theta(double lambda) const = 0;
    virtual double lambda(double theta) const = 0;  ///< >= 0, whatever round-off has made of theta.

    /// Error of an eigenvalue theta, for a relative error of all that S is applied to.
    virtual double errorOf(double theta, double relative) const = 0;

    /// The frequency that is resolved best, and one beyond which there is none.
    virtual double centralFrequency() const = 0;
    virtual double lastFrequency() const = 0;

    /// Whether the basis is to be kept orthogonal. Applications of A are so cheap that some more of
    /// them, which make up for what is lost (Druskin and Knizhnerman 1991), cost less.
    virtual bool isToBeOrthogonal() const = 0;
};

/// S = (W + lambda_p D)^-1 D, with theta = 1/(lambda + lambda_p): a solve for every dimension.
class ShiftInvert final : public KrylovOperator {
  public:
    /// @param ldlt  factorization of W + lambda_p D, kept by reference (see selectPole).
    explicit ShiftInvert(const ShiftedLdlt& ldlt) : ldlt_(ldlt) {}

    Eigen::ArrayXd apply(const Eigen::VectorXd& D, const double* Q, int columns,
                         double* Y) const override;
    Index rows() const override { return ldlt_.orderedRows(); }
    const int* order() const override { return ldlt_.factorOrder().data(); }
    const int* inverseOrder() const override { return ldlt_.inverseOrder().data(); }
    double theta(double lambda) const override { return 1.0 / (lambda - ldlt_.shift()); }
    double lambda(double theta) const override;
    double errorOf(double theta, double relative) const override { return relative * theta; }
    double centralFrequency() const override;
    double lastFrequency() const override;
    bool isToBeOrthogonal() const override { return true; }

  private:
    const ShiftedLdlt& ldlt_;
};

/// S = A over a bound of its eigenvalues, so that theta is in [0, 1]: a product with W for every
/// dimension, no factorization, no memory for one.
///
/// It needs few dimensions where the spectrum ends some octaves beyond the frequencies that F tells
/// apart, or where little of the signal is in its end, as of some slivers. Errors are relative to
/// the largest eigenvalue.
class Products final : public KrylovOperator {
  public:
    /// @param laplacian  kept by reference.
    /// @param central    frequency around which F varies.
    /// @throws Error  of code OutOfMemory, when there is none for the vectors of a space without a
    /// basis.
    Products(const Laplacian& laplacian, double central);

    Eigen::ArrayXd apply(const Eigen::VectorXd& D, const double* Q, int columns,
                         double* Y) const override;
    Index rows() const override { return laplacian_.D.size(); }
    const int* order() const override { return order_.data(); }
    const int* inverseOrder() const override { return order_.data(); }
    double theta(double lambda) const override { return lambda / largest_; }
    double lambda(double theta) const override { return theta > 0.0 ? theta * largest_ : 0.0; }
    double errorOf(double, double relative) const override { return relative; }
    double centralFrequency() const override { return central_; }
    double lastFrequency() const override;
    bool isToBeOrthogonal() const override { return false; }
    int count() const { return count_; }  ///< Columns that W was multiplied with.

  private:
    const Laplacian& laplacian_;
    double central_;
    double largest_;         // bound of lambda
    Eigen::VectorXi order_;  // that of the mesh
    mutable int count_ = 0;
};

}  // namespace spectral
