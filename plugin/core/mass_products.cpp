#include "mass_products.h"

#include <algorithm>

#include "dense_products.h"
#include "types.h"

namespace spectral {

namespace {

/// Rows at a time: what belongs to them stays in the cache, and needs little room.
constexpr Index kRows = 512;

}  // namespace

Eigen::MatrixXd innerProducts(const Eigen::Ref<const Eigen::MatrixXd>& A, const Eigen::VectorXd& D,
                              const Eigen::Ref<const Eigen::MatrixXd>& B) {
    const Index n = A.rows(), p = A.cols(), q = B.cols();
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(p, q), part(p, q);
    if (p == 0 || q == 0) return sum;
    Eigen::MatrixXd DB(kRows, q);
    for (Index row = 0; row < n; row += kRows) {
        const Index rows = std::min(kRows, n - row);
        DB.topRows(rows) = D.segment(row, rows).asDiagonal() * B.middleRows(row, rows);
        denseProducts().transposedProduct(&A.coeffRef(row, 0), A.outerStride(), DB.data(), kRows,
                                          part.data(), p, rows, p, q);
        sum += part;
    }
    return sum;
}

Eigen::MatrixXd gramMatrix(const Eigen::Ref<const Eigen::MatrixXd>& S, const Eigen::VectorXd& D) {
    const Index n = S.rows(), m = S.cols();
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(m, m), part = sum;
    if (m == 0) return sum;
    Eigen::MatrixXd DS(kRows, m);
    for (Index row = 0; row < n; row += kRows) {
        const Index rows = std::min(kRows, n - row);
        DS.topRows(rows) = D.segment(row, rows).asDiagonal() * S.middleRows(row, rows);
        denseProducts().upperTransposedProduct(&S.coeffRef(row, 0), S.outerStride(), DS.data(),
                                               kRows, part.data(), m, rows, m);
        sum += part;
    }
    sum.triangularView<Eigen::StrictlyLower>() = sum.transpose();
    return sum;
}

void subtractProduct(const Eigen::Ref<const Eigen::MatrixXd>& A, const Eigen::MatrixXd& C,
                     Eigen::Ref<Eigen::MatrixXd> B) {
    const Index n = A.rows(), p = A.cols(), q = B.cols();
    if (p == 0 || q == 0) return;
    Eigen::MatrixXd AC(kRows, q);
    for (Index row = 0; row < n; row += kRows) {
        const Index rows = std::min(kRows, n - row);
        denseProducts().product(&A.coeffRef(row, 0), A.outerStride(), C.data(), p, AC.data(), kRows,
                                rows, p, q);
        B.middleRows(row, rows) -= AC.topRows(rows);
    }
}

void multiplyInPlace(Eigen::Ref<Eigen::MatrixXd> A, const Eigen::MatrixXd& C) {
    const Index n = A.rows(), p = A.cols(), q = C.cols();
    if (q == 0) return;
    Eigen::MatrixXd AC(kRows, q);
    for (Index row = 0; row < n; row += kRows) {
        const Index rows = std::min(kRows, n - row);
        denseProducts().product(&A.coeffRef(row, 0), A.outerStride(), C.data(), p, AC.data(), kRows,
                                rows, p, q);
        A.block(row, 0, rows, q) = AC.topRows(rows);
    }
}

}  // namespace spectral
