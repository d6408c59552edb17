#include "core/krylov/krylov_operator.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/krylov/rows.h"
#include "core/support/threads.h"

namespace spectral {

namespace {

/// Y <- D^-1 W Q / unit; returns the diagonal of Q^T D Y.
template <int Columns>
Row<Columns> multiply(const Laplacian& laplacian, double unit, const double* Q, double* Y) {
    const double inverse = 1.0 / unit;
    const SparseMatrix& W = laplacian.W;  // symmetric: its columns are its rows
    const auto* begins = W.outerIndexPtr();
    const auto* neighbours = W.innerIndexPtr();
    const double* weights = W.valuePtr();
    return parallelSum(W.rows(), Row<Columns>::Zero().eval(), [&](Index begin, Index end) {
        Row<Columns> products = Row<Columns>::Zero();
        for (Index i = begin; i < end; ++i) {
            Row<Columns> sum = Row<Columns>::Zero();
            for (auto k = begins[i]; k < begins[i + 1]; ++k)
                sum += weights[k] * rowOf<Columns>(Q, neighbours[k]);
            sum *= inverse;
            products += rowOf<Columns>(Q, i) * sum;
            rowOf<Columns>(Y, i) = sum / laplacian.D[i];
        }
        return products;
    });
}

/// The diagonal of Q^T D Y.
template <int Columns>
Row<Columns> innerProducts(const Eigen::VectorXd& D, const double* Q, const double* Y) {
    return parallelSum(D.size(), Row<Columns>::Zero().eval(), [&](Index begin, Index end) {
        Row<Columns> sum = Row<Columns>::Zero();
        for (Index i = begin; i < end; ++i)
            sum += D[i] * rowOf<Columns>(Q, i) * rowOf<Columns>(Y, i);
        return sum;
    });
}

/// Powers beside ones that the bound is sharpened by, each a pass over W: the second saves 1 to 5 %
/// of the terms of a series, a third less than half a term.
constexpr int kPowers = 2;

/// Bound on the eigenvalues of D^-1 W: those of M = D^-1 |W| are at most max_i (M x)_i / x_i, for
/// any x > 0 (Collatz 1942). x = 1 gives Gershgorin's bound, x = M^k 1 ever sharper ones: where
/// slivers have the largest row sums, down to half of it.
double eigenvalueBound(const Laplacian& laplacian) {
    const SparseMatrix& W = laplacian.W;
    Eigen::VectorXd x = Eigen::VectorXd::Ones(W.rows()), Mx(W.rows());
    double bound = 0.0;
    for (int power = 0; power <= kPowers; ++power) {
        if (power > 0) x = Mx / std::max(bound, std::numeric_limits<double>::min());
        bound = parallelMax(W.rows(), [&](Index begin, Index end) {
            double largest = 0.0;
            for (Index i = begin; i < end; ++i) {
                double sum = 0.0;
                for (SparseMatrix::InnerIterator entry(W, i); entry; ++entry)
                    sum += std::abs(entry.value()) * x[entry.row()];
                Mx[i] = sum / laplacian.D[i];
                if (x[i] > 0.0) largest = std::max(largest, Mx[i] / x[i]);  // 0: no neighbours
            }
            return largest;
        });
    }
    return bound;
}

}  // namespace

Eigen::ArrayXd ShiftInvert::apply(const Eigen::VectorXd& D, const double* Q, int columns,
                                  double* Y) const {
    parallelRows(D.size(), [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i)
            for (Index k = i * columns; k < (i + 1) * columns; ++k) Y[k] = D[i] * Q[k];
    });
    ldlt_.solveOrdered(Y, columns);
    const auto products = [&](auto count) {
        return Eigen::ArrayXd(innerProducts<count>(D, Q, Y).transpose());
    };
    return columns == kMaxSignalsOfSeries
               ? products(std::integral_constant<int, kMaxSignalsOfSeries>())
               : withColumns(columns, products);
}

double ShiftInvert::lambda(double theta) const {
    return theta > 0.0 ? std::max(0.0, 1.0 / theta + ldlt_.shift())
                       : std::numeric_limits<double>::infinity();
}

double ShiftInvert::centralFrequency() const { return std::sqrt(-ldlt_.shift()); }

double ShiftInvert::lastFrequency() const { return std::numeric_limits<double>::infinity(); }

Products::Products(const Laplacian& laplacian, double central)
    : laplacian_(laplacian),
      central_(central),
      largest_(std::max(eigenvalueBound(laplacian), std::numeric_limits<double>::min())),
      order_(Eigen::VectorXi::LinSpaced(laplacian.D.size(), 0,
                                        static_cast<int>(laplacian.D.size()) - 1)) {}

Eigen::ArrayXd Products::apply(const Eigen::VectorXd&, const double* Q, int columns,
                               double* Y) const {
    return withColumns(columns, [&](auto count) {
        return Eigen::ArrayXd(multiply<count>(laplacian_, largest_, Q, Y).transpose());
    });
}

double Products::lastFrequency() const { return std::sqrt(largest_); }

}  // namespace spectral
