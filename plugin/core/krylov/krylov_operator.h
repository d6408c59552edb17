#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/laplacian/laplacian.h"
#include "core/ldlt/shifted_ldlt.h"

namespace spectral {

/// An operator S whose Krylov spaces approximate functions of A = D^-1 W: it has the eigenvectors
/// of A, and its eigenvalues theta are a monotonic function of the eigenvalues lambda of A.
///
/// Vectors are in the operator's own order, with scratch rows after the n rows of the mesh.
class KrylovOperator {
  public:
    virtual ~KrylovOperator() = default;

    /// Y <- S Q, on the threads of the caller's team.
    /// @param D  n masses, in the order of S, like all rows.
    /// @param Q  n rows of `columns` numbers each, contiguous.
    /// @param Y  rows() rows of the same layout.
    /// @return   the D-inner product of each column of Q with the same column of Y.
    virtual Eigen::ArrayXd apply(const Eigen::VectorXd& D, const double* Q, int columns,
                                 double* Y) const = 0;

    virtual Index rows() const = 0;
    virtual const int* order() const = 0;         ///< The row of each vertex, n.
    virtual const int* inverseOrder() const = 0;  ///< The vertex of each row, n.

    virtual double theta(double lambda) const = 0;
    virtual double lambda(double theta) const = 0;  ///< >= 0, even if round-off makes theta < 0.

    /// Error of an eigenvalue theta, given the relative error of applying S.
    virtual double errorOf(double theta, double relative) const = 0;

    virtual double centralFrequency() const = 0;  ///< The frequency that is resolved best.
    virtual double lastFrequency() const = 0;     ///< Upper bound of all frequencies.

    /// Whether S is A itself, but for a factor: then theta is lambda over its largest value.
    virtual bool isProduct() const = 0;
};

/// S = (W + lambda_p D)^-1 D, with theta = 1/(lambda + lambda_p): one solve per dimension.
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
    bool isProduct() const override { return false; }

  private:
    const ShiftedLdlt& ldlt_;
};

/// S = A divided by a bound of its eigenvalues, so that theta is in [0, 1]: one product with W per
/// dimension; neither a factorization nor memory for one.
///
/// Takes few dimensions where the spectrum ends a few octaves above the frequencies at which F
/// varies, or where little of the signal lies at its end, as with a few slivers. Errors are
/// relative to the largest eigenvalue.
class Products final : public KrylovOperator {
  public:
    /// @param laplacian  kept by reference.
    /// @param central    frequency around which F varies.
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
    bool isProduct() const override { return true; }

  private:
    const Laplacian& laplacian_;
    double central_;
    double largest_;         // upper bound of lambda
    Eigen::VectorXi order_;  // identity: vectors are in the order of the mesh
};

}  // namespace spectral
