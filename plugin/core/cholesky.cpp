#include "cholesky.h"

#include <algorithm>
#include <string>

#include "errors.h"

namespace spectral {

namespace {

bool samePattern(const SparseMatrix& A, const SparseMatrix& B) {
    return A.rows() == B.rows() && A.nonZeros() == B.nonZeros() &&
           std::equal(A.outerIndexPtr(), A.outerIndexPtr() + A.outerSize() + 1,
                      B.outerIndexPtr()) &&
           std::equal(A.innerIndexPtr(), A.innerIndexPtr() + A.nonZeros(), B.innerIndexPtr());
}

SparseMatrix shifted(const Laplacian& laplacian, double shift) {
    SparseMatrix A = laplacian.W;
    A.diagonal() += shift * laplacian.D;
    return A;
}

}  // namespace

void ShiftedCholesky::factorize(const Laplacian& laplacian, double shift) {
    const bool known = samePattern(analyzed_, laplacian.W);
    analyzed_ = shifted(laplacian, shift);
    if (!known) llt_.analyzePattern(analyzed_);
    llt_.factorize(analyzed_);
    shift_ = shift;
    ++factorizations_;
    if (llt_.info() != Eigen::Success)
        throw SolverFailure(
            "the sparse Cholesky factorization of W + s D (" + std::to_string(laplacian.W.rows()) +
            " vertices) broke down: the matrix is not positive definite to working precision, "
            "because triangles are degenerate or have collapsed. Apply 'Remove Zero Area Faces' or "
            "'Remeshing: Isotropic Explicit Remeshing' first");
}

Eigen::MatrixXd ShiftedCholesky::solve(const Eigen::MatrixXd& B) const {
    Eigen::MatrixXd X(B.rows(), B.cols());
    // The factor is far larger than the cache: each pass over it serves as many columns as it can.
    Index c = 0;
    for (; c + 4 <= B.cols(); c += 4) solveColumns<4>(B, c, X);
    switch (B.cols() - c) {
        case 3: solveColumns<3>(B, c, X); break;
        case 2: solveColumns<2>(B, c, X); break;
        case 1: solveColumns<1>(B, c, X); break;
        default: break;
    }
    solves_ += static_cast<int>(B.cols());
    return X;
}

template <int Columns>
void ShiftedCholesky::solveColumns(const Eigen::MatrixXd& B, Index first,
                                   Eigen::MatrixXd& X) const {
    const SparseMatrix& L = llt_.matrixL().nestedExpression();
    const Eigen::VectorXi& order = llt_.permutationP().indices();
    const int* start = L.outerIndexPtr();
    const int* row = L.innerIndexPtr();
    const double* value = L.valuePtr();
    const Index n = L.rows();

    using Row = Eigen::Array<double, 1, Columns>;
    Eigen::Array<double, Eigen::Dynamic, Columns, (Columns > 1 ? Eigen::RowMajor : Eigen::ColMajor)>
        Y(n, Columns);
    for (Index i = 0; i < n; ++i) Y.row(order[i]) = B.row(i).segment<Columns>(first).array();
    // L Y = P B. A column of L begins with its diagonal entry.
    for (Index j = 0; j < n; ++j) {
        const Row y = Y.row(j) / value[start[j]];
        Y.row(j) = y;
        for (int p = start[j] + 1; p < start[j + 1]; ++p) Y.row(row[p]) -= value[p] * y;
    }
    // L^T Z = Y
    for (Index j = n - 1; j >= 0; --j) {
        Row y = Y.row(j);
        for (int p = start[j] + 1; p < start[j + 1]; ++p) y -= value[p] * Y.row(row[p]);
        Y.row(j) = y / value[start[j]];
    }
    for (Index i = 0; i < n; ++i) X.row(i).segment<Columns>(first) = Y.row(order[i]).matrix();
}

Index ShiftedCholesky::countEigenvaluesBelow(const Laplacian& laplacian, double sigma) {
    ++factorizations_;
    const Eigen::SimplicialLDLT<SparseMatrix, Eigen::Lower, Eigen::AMDOrdering<int>> ldlt(
        shifted(laplacian, -sigma));
    if (ldlt.info() != Eigen::Success)
        throw SolverFailure("the LDL^T factorization of W - sigma D met a zero pivot at sigma = " +
                            std::to_string(sigma));
    return (ldlt.vectorD().array() < 0.0).count();
}

}  // namespace spectral
