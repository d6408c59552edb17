#pragma once

#include <Eigen/Core>
#include <vector>

#include "cholesky.h"
#include "components.h"
#include "transfer_function.h"

namespace spectral {

/// A sum of point masses on the frequencies.
struct Quadrature {
    Eigen::VectorXd omega;   ///< m nodes, >= 0, in no order, radians per length unit.
    Eigen::VectorXd weight;  ///< m weights, >= 0.
};

/// Shift-invert Lanczos recurrence of one signal x, for M = D^1/2 (W + lambda_p D)^-1 D^1/2, the
/// symmetric form of S = (W + lambda_p D)^-1 D, with full reorthogonalization.
///
/// S is self-adjoint in the D-inner product and has the eigenvectors of A with eigenvalues theta =
/// 1/(lambda + lambda_p). With U the D-orthonormal basis of the Krylov space of S and x, and T =
/// U^T D S U,
///     f(A) x     ~ |x|_D U f(T^-1 - lambda_p) e_1,
///     x^T D f(A) x ~ |x|_D^2 e_1^T f(T^-1 - lambda_p) e_1.
/// The second is Gauss quadrature of the spectral measure of x (Golub and Meurant 1994): m
/// dimensions are exact for polynomials in theta of degree 2m - 1, twice that of the first.
class LanczosColumn {
  public:
    /// @param start  D^1/2 x, n.
    explicit LanczosColumn(const Eigen::VectorXd& start);

    /// Whether the space is invariant under S: there is nothing more to find.
    bool exhausted() const { return exhausted_; }
    int dimension() const { return static_cast<int>(alpha_.size()); }

    /// The newest basis vector, times D^1/2.
    auto current() const { return basis_.col(dimension()); }

    /// Takes w = M current() and makes the next basis vector of it.
    void extend(Eigen::VectorXd w);

    /// Coefficients |x|_D F(sqrt(T^-1 - pole)) e_1 of the present approximation in the basis.
    /// @throws SolverFailure  when the eigenproblem of T does not converge.
    Eigen::VectorXd coefficients(const Gain& gain, double pole) const;

    /// Nodes and weights of the Gauss quadrature; the weights sum to |x|_D^2.
    /// @throws SolverFailure  when the eigenproblem of T does not converge.
    Quadrature quadrature(double pole) const;

    /// The signal, times D^1/2, with these coefficients in the basis.
    Eigen::VectorXd combine(const Eigen::VectorXd& coefficients) const {
        return basis_.leftCols(coefficients.size()) * coefficients;
    }

  private:
    /// Eigenpairs of T: frequencies of the Ritz values, and eigenvectors as columns.
    struct Ritz {
        Eigen::VectorXd omega;
        Eigen::MatrixXd Q;
    };
    Ritz ritz(double pole) const;

    void reorthogonalize(Eigen::VectorXd& w) const;

    Eigen::MatrixXd basis_;  // D^1/2 U, with room to grow
    std::vector<double> alpha_, beta_;
    double norm_ = 0.0;
    bool exhausted_ = false;
};

/// Extends all columns that are not exhausted by one dimension, with one pass over the Cholesky
/// factor for all of them; returns whether there was such a column.
///
/// @param sqrtD     square roots of the lumped masses.
/// @param cholesky  factorization of W + lambda_p D.
bool extendColumns(std::vector<LanczosColumn>& columns, const Eigen::VectorXd& sqrtD,
                   const ConstantModes& constants, const ShiftedCholesky& cholesky);

}  // namespace spectral
