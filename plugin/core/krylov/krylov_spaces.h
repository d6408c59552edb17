#pragma once

#include <Eigen/Core>
#include <tuple>
#include <variant>
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

/// How Krylov spaces keep their bases.
enum class KeptBasis {
    Double,
    Single,  ///< With an error of 1e-7 in combinations of it; T is in double precision all the
             ///< same.
    None     ///< For quadrature, which T is enough for, orthogonal or not (Golub and Meurant), and
             ///< for combinations in a second pass: see restart.
};

/// Vectors of bases that are no longer used, for the spaces that follow: fresh memory costs as much
/// as the rest of a dimension.
using SpareVectors = std::tuple<std::vector<Eigen::VectorXd>, std::vector<Eigen::VectorXf>>;

/// Lanczos recurrences of several signals in step: each application of an operator S extends all of
/// their Krylov spaces.
///
/// S is self-adjoint in the D-inner product and has the eigenvectors of A (krylov_operator.h). With
/// U the D-orthonormal basis of the Krylov space of S and a signal x, the tridiagonal T = U^T D S
/// U, and lambda(T) A's eigenvalues in place of those of T,
///     f(A) x       ~ |x|_D U f(lambda(T)) e_1,
///     x^T D f(A) x ~ |x|_D^2 e_1^T f(lambda(T)) e_1.
/// The second is Gauss quadrature of the spectral measure of x (Golub and Meurant 1994): m
/// dimensions are exact for polynomials in theta of degree 2m - 1, twice that of the first.
///
/// The recurrence keeps the basis orthogonal until a Ritz value converges. Only then is it
/// reorthogonalized, which costs more than all the rest (partial reorthogonalization, Simon 1984).
///
/// Vectors are stored in the order of S, the values of all signals at a vertex next to each other.
/// Work is shared by the threads of the caller's team.
class KrylovSpaces {
  public:
    /// Largest inner product of an orthogonal basis. Semiorthogonality, 1e-8 (Simon 1984), would
    /// keep T accurate, but not combinations of the basis.
    static constexpr double kOrthogonal = 1e-10;

    /// @param S, laplacian  kept by reference; the constant modes are removed from all vectors.
    /// @param X  n x c signals, 1 <= c <= kMostSignals.
    /// @param orthogonal  inner product of two vectors at which they are reorthogonalized, where S
    ///                    wants that.
    /// @param kept  the basis; combinations of none are not to be asked for.
    /// @param spare  where vectors are taken from, and left in the end; null for none.
    KrylovSpaces(const KrylovOperator& S, const Laplacian& laplacian, const Eigen::MatrixXd& X,
                 double orthogonal = kOrthogonal, KeptBasis kept = KeptBasis::Double,
                 SpareVectors* spare = nullptr);
    ~KrylovSpaces();
    KrylovSpaces(const KrylovSpaces&) = delete;
    KrylovSpaces& operator=(const KrylovSpaces&) = delete;

    int columns() const { return columns_; }

    /// Extends by one dimension all spaces that are not yet invariant under S; returns whether
    /// there were any. Results from an invariant space are exact.
    bool extend();

    /// Coefficients |x|_D F(sqrt(lambda(T))) e_1 of F(sqrt(A)) x in the basis.
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

    /// Begins anew with the same signals: extend() repeats the recurrence, and addNewest combines
    /// the vectors of a basis that is not kept, for twice the products (two-pass Lanczos).
    void restart(const Eigen::MatrixXd& X);

    /// Y += the newest vector of each column's basis times its factor; Y is n x c, in mesh order.
    void addNewest(const Eigen::RowVectorXd& factors, Eigen::MatrixXd& Y) const;

    /// D-norm of each signal without its constants, c.
    const Eigen::ArrayXd& norms() const { return norms_; }
    /// Largest modulus of the entries of the signals without their constants.
    double largestEntry() const { return largestEntry_; }

    /// Round-off in S, relative to its norm: the largest constant part of S q, which should be
    /// zero, for any vector q of the bases; at least what counts as zero in a breakdown.
    double roundOff() const { return roundOff_; }

  private:
    /// Of n rows of columns_ values.
    template <class Scalar>
    using Vectors = std::vector<Eigen::Matrix<Scalar, Eigen::Dynamic, 1>>;

    /// Eigenpairs of T: frequencies of the Ritz values, and eigenvectors as columns.
    struct Ritz {
        Eigen::VectorXd omega;
        Eigen::MatrixXd Q;
    };
    const Ritz& ritz(int column) const;

    template <int Columns>
    void start(const Eigen::MatrixXd& X);
    template <int Columns>
    void extendColumns();
    template <int Columns, class MakeRow>
    void append(const MakeRow& row);
    bool losesOrthogonality(const Eigen::Ref<const Eigen::ArrayXd>& beta);
    template <int Columns>
    Eigen::Array<double, 1, Columns> orthogonalize(Eigen::Array<double, 1, Columns> norm,
                                                   double* w);
    template <int Columns, class TakeRow>
    void combineColumns(const std::vector<Eigen::VectorXd>& coefficients,
                        const TakeRow& takeRow) const;

    const KrylovOperator& S_;
    const ConstantModes& constants_;
    double orthogonal_;
    int columns_;
    Eigen::VectorXd D_;      // in the order of S, like all that follow
    Eigen::VectorXi label_;  // components; see ConstantModes
    KeptBasis kept_;
    double unit_ = 1.0;  // of the stored basis: numbers in single precision have few exponents
    std::variant<Vectors<double>, Vectors<float>> basis_;
    SpareVectors* spare_;
    Eigen::VectorXd newest_, before_, next_;  // of the basis, with rows of scratch behind; see S
    std::vector<std::vector<double>> alpha_, beta_;  // diagonal and off-diagonal of T, by column

    mutable std::vector<Ritz> ritz_;  // of the last T that was asked for, by column

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
