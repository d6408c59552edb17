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

void product(const SymmetricSparse& W, const double* S, Size strideS, Size columns, double* WS,
             Size strideWS) {
    Eigen::Array<double, Eigen::Dynamic, kColumns, Eigen::RowMajor> in(W.n, kColumns);
    Eigen::Array<double, kRows, kColumns, Eigen::RowMajor> out;
    for (Size first = 0; first < columns; first += kColumns) {
        const Size count = std::min<Size>(kColumns, columns - first);
        if (count < kColumns) in.setZero();
        in.leftCols(count) =
            ConstMatrix(S + first * strideS, W.n, count, Eigen::OuterStride<>(strideS)).array();
        Matrix result(WS + first * strideWS, W.n, count, Eigen::OuterStride<>(strideWS));
        for (Size row = 0; row < W.n; row += kRows) {
            const Size rows = std::min<Size>(kRows, W.n - row);
            for (Size i = 0; i < rows; ++i) {
                // As W is symmetric its columns serve as rows, so that each result is written once.
                Eigen::Array<double, 1, kColumns> sum = Eigen::Array<double, 1, kColumns>::Zero();
                for (int p = W.starts[row + i]; p < W.starts[row + i + 1]; ++p)
                    sum += W.values[p] * in.row(W.rows[p]);
                out.row(i) = sum;
            }
            if (rows == kRows && count == kColumns)
                result.middleRows<kRows>(row) = out.matrix();
            else
                result.middleRows(row, rows) = out.topLeftCorner(rows, count).matrix();
        }
    }
}

}  // namespace

namespace SPECTRAL_INSTRUCTIONS {
extern const SparseProducts sparseProducts;
const SparseProducts sparseProducts{product};
}  // namespace SPECTRAL_INSTRUCTIONS

}  // namespace spectral
