#include "indefinite_factor.h"

#include <string>

#include "errors.h"

namespace spectral {

namespace {

constexpr int kMaxAttempts = 4;

/// Relative change of a shift that has met an eigenvalue of a leading minor.
constexpr double kNudge = 1e-7;

}  // namespace

IndefiniteFactor::IndefiniteFactor(const Laplacian& laplacian) : laplacian_(laplacian) {
    ldlt_.analyzePattern(laplacian.W);
}

void IndefiniteFactor::factorize(double sigma) {
    for (int attempt = 0; attempt < kMaxAttempts; ++attempt) {
        shift_ = sigma * (1.0 + attempt * kNudge);
        SparseMatrix A = laplacian_.W;
        A.diagonal() -= shift_ * laplacian_.D;
        ldlt_.factorize(A);
        if (ldlt_.info() != Eigen::Success) continue;
        pivots_ = ldlt_.vectorD();
        below_ = (pivots_.array() < 0.0).count();
        return;
    }
    throw SolverFailure("the LDL^T factorization of W - sigma D meets a zero pivot at sigma = " +
                        std::to_string(sigma));
}

Eigen::MatrixXd IndefiniteFactor::solve(const Eigen::MatrixXd& B) const {
    Eigen::MatrixXd X(B.rows(), B.cols());
    Index c = 0;
    for (; c + 4 <= B.cols(); c += 4) solveColumns<4>(B, c, X);
    for (; c < B.cols(); ++c) solveColumns<1>(B, c, X);
    return X;
}

template <int Columns>
void IndefiniteFactor::solveColumns(const Eigen::MatrixXd& B, Index first,
                                    Eigen::MatrixXd& X) const {
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
