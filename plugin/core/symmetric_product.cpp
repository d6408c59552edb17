#include "symmetric_product.h"

#include <algorithm>

namespace spectral {

namespace {

/// Columns that are taken at once: a row of them is a line of the cache.
constexpr int kColumns = 8;

using Block = Eigen::Array<double, Eigen::Dynamic, kColumns, Eigen::RowMajor>;

}  // namespace

Eigen::MatrixXd symmetricProduct(const SparseMatrix& W,
                                 const Eigen::Ref<const Eigen::MatrixXd>& S) {
    const Index n = W.rows();
    const int* const starts = W.outerIndexPtr();
    const int* const rows = W.innerIndexPtr();
    const double* const values = W.valuePtr();
    Eigen::MatrixXd WS(n, S.cols());
    Block in = Block::Zero(n, kColumns), out(n, kColumns);
    for (Index first = 0; first < S.cols(); first += kColumns) {
        const Index count = std::min<Index>(kColumns, S.cols() - first);
        in.leftCols(count) = S.middleCols(first, count);
        for (Index j = 0; j < n; ++j) {
            Eigen::Array<double, 1, kColumns> sum = Eigen::Array<double, 1, kColumns>::Zero();
            for (int p = starts[j]; p < starts[j + 1]; ++p) sum += values[p] * in.row(rows[p]);
            out.row(j) = sum;
        }
        WS.middleCols(first, count) = out.leftCols(count);
    }
    return WS;
}

}  // namespace spectral
