#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/krylov/krylov_operator.h"
#include "core/krylov/rows.h"
#include "core/laplacian/laplacian.h"
#include "core/support/types.h"

namespace spectral {

/// Quadrature nodes and weights on the frequencies.
struct Quadrature {
    Eigen::VectorXd omega;   ///< m nodes, >= 0, radians per length unit, in no particular order.
    Eigen::VectorXd weight;  ///< m weights, >= 0.
};

/// Simultaneous Lanczos recurrences for several signals: each application of an operator S extends
/// the Krylov spaces of all signals.
///
/// S is self-adjoint in the D-inner product and has the eigenvectors of A (krylov_operator.h). With
/// U the D-orthonormal basis of the Krylov space of S and a signal x, the tridiagonal T = U^T D S
/// U, and lambda(T) A's eigenvalues in place of those of T,
///     f(A) x       ~ |x|_D U f(lambda(T)) e_1,
///     x^T D f(A) x ~ |x|_D^2 e_1^T f(lambda(T)) e_1.
/// The second is Gauss quadrature of the spectral measure of x (Golub and Meurant 1994): m
/// dimensions are exact for polynomials in theta of degree 2m - 1, twice that of the first.
///
/// The recurrence keeps the basis orthogonal until a Ritz value converges. Reorthogonalization,
/// the most expensive part, starts only then (partial reorthogonalization, Simon 1984).
///
/// Vectors are stored in the order of S, with the values of all signals at a vertex contiguous. The
/// threads of the caller's team share the work.
class KrylovSpaces {
  public:
    /// Largest inner product that counts as orthogonal. Semiorthogonality, 1e-8 (Simon 1984), would
    /// keep T accurate, but not linear combinations of the basis.
    static constexpr double kOrthogonal = 1e-10;

    /// @param S, laplacian  kept by reference; the constant modes are removed from all vectors.
    /// @param X  n x c signals, 1 <= c <= kMaxSignals.
    /// @param orthogonal  largest inner product of two basis vectors before reorthogonalization.
    /// @param isKept  whether the basis is kept, orthogonal; quadrature needs only T, of an
    /// orthogonal
    ///                basis or not (Golub and Meurant 1994).
    KrylovSpaces(const KrylovOperator& S, const Laplacian& laplacian, const Signals& X,
                 double orthogonal = kOrthogonal, bool isKept = true);
    KrylovSpaces(const KrylovSpaces&) = delete;
    KrylovSpaces& operator=(const KrylovSpaces&) = delete;

    int columns() const { return columns_; }

    /// Extends all spaces that are not yet invariant under S by one dimension; returns false if
    /// there were none. Results from an invariant space are exact.
    bool extend();

    /// Coefficients |x|_D F(sqrt(lambda(T))) e_1 of F(sqrt(A)) x in the basis.
    /// @throws SolverFailure  when the eigenproblem of T does not converge.
    Eigen::VectorXd coefficients(int column, const Gain& gain) const;

    /// Bound of the squared error |F(sqrt(A)) x - U c|_D^2 of coefficients c, from F at samples.
    ///
    /// U c is p(S) x with p = sum_k c_k p_k, where the polynomials p_k are orthonormal for the
    /// spectral measure of x: those of the recurrence T. So an eigenvalue of S at theta adds (F -
    /// p)(theta)^2 times its mass, which is at most the Christoffel function 1 / sum_k p_k(theta)^2
    /// of the measure, whether theta lies between two Ritz values or beyond them all. The bound
    /// sums the largest of these products over the intervals between neighbouring Ritz values. It
    /// detects a band of F between Ritz values, but ignores it where the signal has no energy.
    ///
    /// @param omega  frequencies, ascending or descending, dense enough to resolve every band of F.
    /// @param gains  F at these frequencies.
    double squaredErrorBound(int column, const Eigen::VectorXd& c, const Eigen::VectorXd& omega,
                             const Eigen::VectorXd& gains) const;

    /// Nodes and weights of the Gauss quadrature; the weights sum to |x|_D^2.
    /// @throws SolverFailure  when the eigenproblem of T does not converge.
    Quadrature quadrature(int column) const;

    /// The signals with these coefficients in their bases, n x c, in mesh order.
    /// @param coefficients  one vector per column, at most as long as the column's dimension.
    Eigen::MatrixXd combine(const std::vector<Eigen::VectorXd>& coefficients) const;

    /// The same for several sets of coefficients: each basis vector is read only once.
    std::vector<Eigen::MatrixXd> combineAll(
        const std::vector<std::vector<Eigen::VectorXd>>& sets) const;

    /// Largest modulus of the entries of combine(coefficients).
    double largestEntryOf(const std::vector<Eigen::VectorXd>& coefficients) const;

    /// D-norm of each signal without its constants, c.
    const Eigen::ArrayXd& norms() const { return norms_; }
    /// Largest modulus of the entries of the signals without their constants.
    double largestEntry() const { return largestEntry_; }

    /// Round-off in S, relative to its norm: the largest constant part of S q, which should be
    /// zero, over all basis vectors q; never below the breakdown threshold.
    double roundOff() const { return roundOff_; }

  private:
    /// Eigenpairs of T: frequencies of the Ritz values, and eigenvectors as columns.
    struct Ritz {
        Eigen::VectorXd omega;
        Eigen::MatrixXd Q;
    };
    const Ritz& ritz(int column) const;

    template <int Columns>
    void start(const Signals& X);
    template <int Columns>
    void extendColumns();
    template <int Columns, class MakeRow>
    void append(const MakeRow& row);
    bool losesOrthogonality(const Eigen::Ref<const Eigen::ArrayXd>& beta);
    template <int Columns>
    Eigen::Array<double, 1, Columns> orthogonalize(Eigen::Array<double, 1, Columns> norm,
                                                   double* w);
    template <int Columns, class TakeRow>
    void combineColumns(const std::vector<std::vector<Eigen::VectorXd>>& sets,
                        const TakeRow& takeRow) const;

    const KrylovOperator& S_;
    const ConstantModes& constants_;
    double orthogonal_;
    int columns_;
    Eigen::VectorXd D_;      // in the order of S, like all that follow
    Eigen::VectorXi label_;  // components; see ConstantModes
    bool isKept_;
    std::vector<Eigen::VectorXd> basis_;      // each n rows of columns_ values
    Eigen::VectorXd newest_, before_, next_;  // basis vectors followed by the scratch rows of S
    std::vector<std::vector<double>> alpha_, beta_;  // diagonal and off-diagonal of T, by column

    mutable std::vector<Ritz> ritz_;  // cache: eigenpairs of the latest T, by column

    /// Estimated inner products of the newest vector, and of the one before, with all others.
    std::vector<std::vector<double>> overlap_, overlapBefore_;
    bool orthogonalizesNext_ = false;
    std::vector<bool> exhausted_;      // whether a column's space is invariant
    std::vector<bool> mayBeRoundOff_;  // whether a column's newest vectors may be round-off
    Eigen::ArrayXd norms_;
    double largestEntry_ = 0.0;
    double roundOff_;
};

}  // namespace spectral
