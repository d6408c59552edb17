// Compiled once for each instruction set, as dense_products.cpp is: see there.
#include "sparse_products.h"

#include <Eigen/Core>
#include <algorithm>

namespace spectral {

namespace {

using Size = std::ptrdiff_t;
using Matrix = Eigen::Map<Eigen::MatrixXd, Eigen::Unaligned, Eigen::OuterStride<>>;
using ConstMatrix = Eigen::Map<const Eigen::MatrixXd, Eigen::Unaligned, Eigen::OuterStride<>>;

/// Columns that are taken at once, side by side: a row of them is a line of the cache, and an entry
/// of W is fetched once for all of them.
constexpr int kColumns = 8;

/// Rows of the result that are written at once.
constexpr int kRows = 8;

/// Some columns, each row of them in one piece.
using Rows = Eigen::Array<double, Eigen::Dynamic, kColumns, Eigen::RowMajor>;
using Row = Eigen::Array<double, 1, kColumns>;

/// @param S  the first of `count` columns, at most kColumns.
void copyRows(const double* S, Size strideS, Size count, Rows& rows) {
    if (count < kColumns) rows.setZero();
    rows.leftCols(count) =
        ConstMatrix(S, rows.rows(), count, Eigen::OuterStride<>(strideS)).array();
}

/// A row of W S. As W is symmetric its columns serve as rows.
Row productRow(const SymmetricSparse& W, Size row, const Rows& S) {
    Row sum = Row::Zero();
    for (int p = W.starts[row]; p < W.starts[row + 1]; ++p) sum += W.values[p] * S.row(W.rows[p]);
    return sum;
}

void product(const SymmetricSparse& W, const double* S, Size strideS, Size columns, double* WS,
             Size strideWS) {
    Rows in(W.n, kColumns);
    Eigen::Array<double, kRows, kColumns, Eigen::RowMajor> out;
    for (Size first = 0; first < columns; first += kColumns) {
        const Size count = std::min<Size>(kColumns, columns - first);
        copyRows(S + first * strideS, strideS, count, in);
        Matrix result(WS + first * strideWS, W.n, count, Eigen::OuterStride<>(strideWS));
        for (Size row = 0; row < W.n; row += kRows) {
            const Size rows = std::min<Size>(kRows, W.n - row);
            for (Size i = 0; i < rows; ++i) out.row(i) = productRow(W, row + i, in);
            if (rows == kRows && count == kColumns)
                result.middleRows<kRows>(row) = out.matrix();
            else
                result.middleRows(row, rows) = out.topLeftCorner(rows, count).matrix();
        }
    }
}

void squaredResiduals(const SymmetricSparse& W, const double* D, const double* S, Size strideS,
                      Size columns, const double* lambda, double* squares) {
    Rows in(W.n, kColumns);
    for (Size first = 0; first < columns; first += kColumns) {
        const Size count = std::min<Size>(kColumns, columns - first);
        copyRows(S + first * strideS, strideS, count, in);
        Row values = Row::Zero(), sum = Row::Zero();
        for (Size j = 0; j < count; ++j) values[j] = lambda[first + j];
        for (Size row = 0; row < W.n; ++row)
            sum += (productRow(W, row, in) - values * D[row] * in.row(row)).square() / D[row];
        for (Size j = 0; j < count; ++j) squares[first + j] = sum[j];
    }
}

}  // namespace

namespace SPECTRAL_INSTRUCTIONS {
extern const SparseProducts sparseProducts;
const SparseProducts sparseProducts{product, squaredResiduals};
}  // namespace SPECTRAL_INSTRUCTIONS

}  // namespace spectral
