#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <type_traits>
#include <vector>

#include "core/krylov/krylov_operator.h"
#include "core/krylov/rows.h"
#include "core/laplacian/laplacian.h"
#include "core/support/threads.h"

namespace spectral::series {

/// Round-off of an operation, relative.
inline constexpr double kRoundOff = 1e-15;

/// Signals X (n x c) without the means of their components.
class Centred {
  public:
    Centred(const Signals& X, const Laplacian& laplacian)
        : X_(X),
          label_(laplacian.constants.label()),
          means_(laplacian.constants.means(laplacian.D, X)) {}
    double operator()(Index i, Index c) const {
        return label_[i] < 0 ? X_(i, c) : X_(i, c) - means_(label_[i], c);
    }
    const Eigen::MatrixXd& means() const { return means_; }

  private:
    const Signals& X_;
    const Eigen::VectorXi& label_;
    Eigen::MatrixXd means_;
};

// The operators of the terms of a series (series_evaluation.h). Each gives a row of the details, to
// double precision, and maps rows of a term to those of twice its image.

/// S = A / largest. Of differences, so that constants stay exactly 0.
template <class Scalar, int Columns>
class Product {
  public:
    using Values = Eigen::Array<Scalar, Columns, 1>;
    using Detail = Eigen::Array<double, Columns, 1>;
    static constexpr double kRoundOffOfTerm = std::is_same_v<Scalar, float> ? 6e-8 : kRoundOff;
    static constexpr bool kKeepsConstants = true;
    static constexpr double kBytesOfRow = 7.0 * sizeof(Scalar);

    Product(const Laplacian& laplacian, const KrylovOperator& S, const Signals& X, const Centred&)
        : laplacian_(laplacian), X_(X), largest_(S.lastFrequency() * S.lastFrequency()) {
        const SparseMatrix& W = laplacian.W;  // symmetric: its columns are its rows
        if (laplacian.constants.label().minCoeff() < 0)
            excess_ = W * Eigen::VectorXd::Ones(W.rows());
        weights_.resize(static_cast<std::size_t>(W.nonZeros()));
        parallelRows(W.rows(), [&](Index begin, Index end) {
            for (Index i = begin; i < end; ++i) {
                const double factor = 2.0 / (largest_ * laplacian.D[i]);
                for (Index k = W.outerIndexPtr()[i]; k < W.outerIndexPtr()[i + 1]; ++k)
                    weights_[k] = static_cast<Scalar>(factor * W.valuePtr()[k]);
            }
        });
    }

    Index rowOf(Index vertex) const { return vertex; }
    void release() { std::vector<Scalar>().swap(weights_); }  ///< Frees memory: no more terms.

    /// Row i of S X, to double precision.
    Detail detail(Index i) const {
        Detail sum = Detail::Zero();
        const double* column = X_.data();
        for (Index c = 0; c < X_.cols(); ++c, column += X_.outerStride()) {
            double differences = 0.0;  // a register, unlike sum[c]
            for (SparseMatrix::InnerIterator entry(laplacian_.W, i); entry; ++entry)
                differences += entry.value() * (column[entry.row()] - column[i]);
            sum[c] = differences;
        }
        for (Index c = 0; excess_.size() > 0 && c < X_.cols(); ++c) sum[c] += excess_[i] * X_(i, c);
        return sum / (laplacian_.D[i] * largest_);
    }

    /// Maps i to row i of 2 S T.
    auto twice(const Values* T) const {
        return [T, starts = laplacian_.W.outerIndexPtr(), rows = laplacian_.W.innerIndexPtr(),
                weights = weights_.data(),
                excess = excess_.size() > 0 ? this : nullptr](Index i) -> Values {
            const Values here = T[i];
            Values sum = Values::Zero();
            for (auto k = starts[i], end = starts[i + 1]; k != end; ++k)
                sum += weights[k] * (T[rows[k]] - here);  // 0 on the diagonal
            if (excess != nullptr) sum += excess->ofExcess(i) * here;
            return sum;
        };
    }

  private:
    Scalar ofExcess(Index i) const {
        return static_cast<Scalar>(2.0 * excess_[i] / (largest_ * laplacian_.D[i]));
    }

    const Laplacian& laplacian_;
    const Signals& X_;
    double largest_;
    std::vector<Scalar> weights_;  // the entries of 2 D^-1 W / largest, in the order of W's
    Eigen::VectorXd excess_;       // row sums of W, if there is a fixed boundary
};

/// S / theta_max of a ShiftInvert; rows are in the order of S.
template <int Columns>
class Solve {
  public:
    using Values = Eigen::Array<double, Columns, 1, Eigen::DontAlign>;
    using Detail = Values;
    static constexpr double kRoundOffOfTerm = kRoundOff;
    static constexpr bool kKeepsConstants = false;
    static constexpr double kBytesOfRow = sizeof(Values);

    Solve(const Laplacian& laplacian, const KrylovOperator& S, const Signals& X,
          const Centred& centred)
        : S_(S),
          scale_(1.0 / std::max(S.theta(0.0), S.theta(S.lastFrequency() * S.lastFrequency()))),
          columns_(X.cols()),
          centred_(centred),
          D_(laplacian.D.size()),
          result_(S.rows() * Columns) {
        Eigen::VectorXd shape = Eigen::VectorXd::Zero(result_.size());
        parallelRows(D_.size(), [&](Index begin, Index end) {
            for (Index i = begin; i < end; ++i) {
                D_[rowOf(i)] = laplacian.D[i];
                for (Index c = 0; c < X.cols(); ++c) shape[rowOf(i) * Columns + c] = centred(i, c);
            }
        });
        S.apply(D_, shape.data(), Columns, result_.data());
    }

    Index rowOf(Index vertex) const { return S_.order()[vertex]; }
    void release() { result_.resize(0); }  ///< Frees memory: no more terms.

    /// Row i of (S - theta_0) X / theta_max, before any term.
    Values detail(Index i) const {
        Values row = Eigen::Map<const Values>(result_.data() + rowOf(i) * Columns);
        for (Index c = 0; c < columns_; ++c) row[c] -= S_.theta(0.0) * centred_(i, c);
        return scale_ * row;
    }

    auto twice(const Values* T) {
        S_.apply(D_, T->data(), Columns, result_.data());
        return [result = result_.data(), twice = 2.0 * scale_](Index i) -> Values {
            return twice * Eigen::Map<const Values>(result + i * Columns);
        };
    }

  private:
    const KrylovOperator& S_;
    double scale_;   // 1 / theta_max
    Index columns_;  // of the signals; the others are 0
    const Centred& centred_;
    Eigen::VectorXd D_, result_;
};

}  // namespace spectral::series
