#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/laplacian/constant_modes.h"
#include "core/laplacian/frequency.h"
#include "core/ldlt/shifted_ldlt.h"

namespace spectral {

/// Quadrature nodes and weights on the frequencies.
struct Quadrature {
    Eigen::VectorXd omega;   ///< m nodes, >= 0, radians per length unit, in no particular order.
    Eigen::VectorXd weight;  ///< m weights, >= 0.
};

/// Shift-invert Lanczos recurrences of several signals in step: each pass over the factor of W +
/// lambda_p D extends all of their Krylov spaces.
///
/// S = (W + lambda_p D)^-1 D is self-adjoint in the D-inner product and has the eigenvectors of A
/// with eigenvalues theta = 1/(lambda + lambda_p). With U the D-orthonormal basis of the Krylov
/// space of S and a signal x, and the tridiagonal T = U^T D S U,
///     f(A) x       ~ |x|_D U f(T^-1 - lambda_p) e_1,
///     x^T D f(A) x ~ |x|_D^2 e_1^T f(T^-1 - lambda_p) e_1.
/// The second is Gauss quadrature of the spectral measure of x (Golub and Meurant 1994): m
/// dimensions are exact for polynomials in theta of degree 2m - 1, twice that of the first.
///
/// The recurrence keeps the basis orthogonal until a Ritz value converges. Only then is it
/// reorthogonalized, which costs more than all the rest (partial reorthogonalization, Simon 1984).
///
/// Vectors are stored in factor order, the values of all signals at a vertex next to each other.
/// Work is shared by the threads of the caller's team.
class KrylovSpaces {
  public:
    static constexpr int kMostSignals = 4;

    /// Largest inner product of an orthogonal basis. Semiorthogonality, 1e-8 (Simon 1984), would
    /// keep T accurate, but not combinations of the basis.
    static constexpr double kOrthogonal = 1e-10;

    /// @param ldlt  factorization of W + lambda_p D; kept by reference, like constants.
    /// @param constants  removed from all vectors.
    /// @param X  n x c signals, 1 <= c <= kMostSignals.
    /// @param orthogonal  inner product of two vectors at which they are reorthogonalized.
    KrylovSpaces(const ShiftedLdlt& ldlt, const Eigen::VectorXd& D, const ConstantModes& constants,
                 const Eigen::MatrixXd& X, double orthogonal = kOrthogonal);

    int columns() const { return columns_; }

    /// Extends by one dimension all spaces that are not yet invariant under S; returns whether
    /// there were any. Results from an invariant space are exact.
    bool extend();

    /// Coefficients |x|_D F(sqrt(T^-1 - lambda_p)) e_1 of F(sqrt(A)) x in the basis.
    /// @throws SolverFailure  when the eigenproblem of T does not converge.
    Eigen::VectorXd coefficients(int column, const Gain& gain) const;

    /// Bound of the squared error |F(sqrt(A)) x - U c|_D^2 of coefficients c, from F at samples.
    ///
    /// U c is p(S) x, with p = sum_k c_k p_k in the polynomials p_k that are orthonormal for the
    /// spectral measure of x: those of the recurrence T. So an eigenvalue of S at theta adds (F -
    /// p)(theta)^2 times its mass, which is at most the Christoffel function 1 / sum_k p_k(theta)^2
    /// of the measure, between two Ritz values and beyond them all alike. The bound is the largest
    /// of these products between neighbouring Ritz values, summed. It sees a band of F that lies
    /// between Ritz values, and passes one over where the signal has nothing.
    ///
    /// @param omega  frequencies, ascending or descending, so dense that F has no band between two.
    /// @param gains  F at them.
    double squaredErrorBound(int column, const Eigen::VectorXd& c, const Eigen::VectorXd& omega,
                             const Eigen::VectorXd& gains) const;

    /// Nodes and weights of the Gauss quadrature, likewise; the weights sum to |x|_D^2.
    Quadrature quadrature(int column) const;

    /// The signals with these coefficients in their bases, n x c, in mesh order.
    /// @param coefficients  of every column, at most as many as its dimension.
    Eigen::MatrixXd combine(const std::vector<Eigen::VectorXd>& coefficients) const;

    /// Largest modulus of the entries of combine(coefficients).
    double largestEntryOf(const std::vector<Eigen::VectorXd>& coefficients) const;

    /// D-norm of each signal without its constants, c.
    const Eigen::ArrayXd& norms() const { return norms_; }
    /// Largest modulus of the entries of the signals without their constants.
    double largestEntry() const { return largestEntry_; }

    /// Round-off in S, relative to its norm: the largest constant part of S q, which should be
    /// zero, for any vector q of the bases; at least what counts as zero in a breakdown.
    double roundOff() const { return roundOff_; }

  private:
    using Block = Eigen::VectorXd;  // n rows of columns_ values

    /// Eigenpairs of T: frequencies of the Ritz values, and eigenvectors as columns.
    struct Ritz {
        Eigen::VectorXd omega;
        Eigen::MatrixXd Q;
    };
    Ritz ritz(int column) const;

    template <int Columns>
    void start(const Eigen::MatrixXd& X);
    template <int Columns>
    void extendColumns();
    bool losesOrthogonality(const Eigen::Ref<const Eigen::ArrayXd>& beta);
    template <int Columns>
    Eigen::Array<double, 1, Columns> orthogonalize(Eigen::Array<double, 1, Columns> norm);
    template <int Columns, class TakeRow>
    void combineColumns(const std::vector<Eigen::VectorXd>& coefficients,
                        const TakeRow& takeRow) const;

    const ShiftedLdlt& ldlt_;
    const ConstantModes& constants_;
    double orthogonal_;
    int columns_;
    Eigen::VectorXd D_;      // in factor order, like all that follow
    Eigen::VectorXi label_;  // components; see ConstantModes
    std::vector<Block> basis_;
    Block work_;  // D times the newest vectors; S times them during an extension
    std::vector<std::vector<double>> alpha_, beta_;  // diagonal and off-diagonal of T, by column

    /// Estimated inner products of the newest vector with all others, and of the one before.
    std::vector<std::vector<double>> overlap_, overlapBefore_;
    bool orthogonalizesNext_ = false;
    std::vector<bool> exhausted_;     // whether the space of a column is invariant
    std::vector<bool> isOfRoundOff_;  // whether its newest vectors may be round-off
    Eigen::ArrayXd norms_;
    double largestEntry_ = 0.0;
    double roundOff_;
};

}  // namespace spectral
