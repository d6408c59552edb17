#include "shifted_ldlt.h"

#include <algorithm>
#include <string>

#include "errors.h"

namespace spectral {

namespace {

constexpr int kMaxAttempts = 4;

/// Relative change of a shift that has met an eigenvalue of a leading minor.
constexpr double kNudge = 1e-7;

bool samePattern(const SparseMatrix& A, const SparseMatrix& B) {
    return A.rows() == B.rows() && A.nonZeros() == B.nonZeros() &&
           std::equal(A.outerIndexPtr(), A.outerIndexPtr() + A.outerSize() + 1,
                      B.outerIndexPtr()) &&
           std::equal(A.innerIndexPtr(), A.innerIndexPtr() + A.nonZeros(), B.innerIndexPtr());
}

}  // namespace

void ShiftedLdlt::factorize(const Laplacian& laplacian, double sigma) {
    if (!samePattern(shifted_, laplacian.W)) ldlt_.analyzePattern(laplacian.W);
    for (int attempt = 0; attempt < kMaxAttempts; ++attempt) {
        shift_ = sigma * (1.0 + attempt * kNudge);
        shifted_ = laplacian.W;
        shifted_.diagonal() -= shift_ * laplacian.D;
        ldlt_.factorize(shifted_);
        if (ldlt_.info() != Eigen::Success) continue;
        pivots_ = ldlt_.vectorD();
        if (!pivots_.allFinite()) continue;
        below_ = (pivots_.array() < 0.0).count();
        return;
    }
    throw SolverFailure("the LDL^T factorization of W - sigma D meets a zero pivot at sigma = " +
                        std::to_string(sigma));
}

Eigen::MatrixXd ShiftedLdlt::solve(const Eigen::MatrixXd& B) const {
    Eigen::MatrixXd X(B.rows(), B.cols());
    // The factor is far larger than the cache: each pass over it serves as many columns as it can.
    Index c = 0;
    for (; c + 8 <= B.cols(); c += 8) solveColumns<8>(B, c, X);
    for (; c + 4 <= B.cols(); c += 4) solveColumns<4>(B, c, X);
    switch (B.cols() - c) {
        case 3: solveColumns<3>(B, c, X); break;
        case 2: solveColumns<2>(B, c, X); break;
        case 1: solveColumns<1>(B, c, X); break;
        default: break;
    }
    return X;
}

template <int Columns>
void ShiftedLdlt::solveColumns(const Eigen::MatrixXd& B, Index first, Eigen::MatrixXd& X) const {
    // Strictly below the diagonal; the diagonal of L is 1.
    const SparseMatrix& L = ldlt_.matrixL().nestedExpression();
    const Eigen::VectorXi& order = ldlt_.permutationP().indices();
    const int* start = L.outerIndexPtr();
    const int* row = L.innerIndexPtr();
    const double* value = L.valuePtr();
    const Index n = L.rows();

    using Row = Eigen::Array<double, 1, Columns>;
    Eigen::Array<double, Eigen::Dynamic, Columns, (Columns > 1 ? Eigen::RowMajor : Eigen::ColMajor)>
        Y(n, Columns);
    for (Index i = 0; i < n; ++i) Y.row(order[i]) = B.row(i).segment<Columns>(first).array();
    for (Index j = 0; j < n; ++j) {  // L Y = P B
        const Row y = Y.row(j);
        for (int p = start[j]; p < start[j + 1]; ++p) Y.row(row[p]) -= value[p] * y;
    }
    for (Index j = n - 1; j >= 0; --j) {  // L^T Z = D^-1 Y
        Row y = Y.row(j) / pivots_[j];
        for (int p = start[j]; p < start[j + 1]; ++p) y -= value[p] * Y.row(row[p]);
        Y.row(j) = y;
    }
    for (Index i = 0; i < n; ++i) X.row(i).segment<Columns>(first) = Y.row(order[i]).matrix();
}

}  // namespace spectral
