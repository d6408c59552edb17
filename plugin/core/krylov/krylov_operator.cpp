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

/// Bound on the eigenvalues of D^-1 W: the largest sum of two neighbours' r_i = sum_j |W_ij| /
/// D_ii, j != i, as if all weights were positive. With B the differences along edges and C their
/// weights, W = B^T C B, and B D^-1 B^T C has the same eigenvalues: this is Gershgorin's bound for
/// it (Anderson and Morley 1985). Where one sliver has the largest r_i, it is up to half of 2 max
/// r_i.
double eigenvalueBound(const Laplacian& laplacian) {
    const SparseMatrix& W = laplacian.W;
    Eigen::VectorXd r(W.rows());
    parallelRows(W.rows(), [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) {
            double sum = 0.0, excess = 0.0;  // an edge to a fixed boundary
            for (SparseMatrix::InnerIterator entry(W, i); entry; ++entry) {
                excess += entry.value();
                if (entry.row() != i) sum += std::abs(entry.value());
            }
            r[i] = (sum + std::abs(excess)) / laplacian.D[i];
        }
    });
    return parallelMax(W.rows(), [&](Index begin, Index end) {
        double bound = 0.0;
        for (Index i = begin; i < end; ++i) {
            bound = std::max(bound, r[i]);
            for (SparseMatrix::InnerIterator entry(W, i); entry; ++entry)
                if (entry.row() != i && entry.value() != 0.0)
                    bound = std::max(bound, r[i] + r[entry.row()]);
        }
        return bound;
    });
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
