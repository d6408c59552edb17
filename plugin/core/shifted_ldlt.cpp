#include "shifted_ldlt.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <sstream>
#include <string>

#include "errors.h"
#include "triangular_solves.h"

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
    if (!samePattern(shifted_, laplacian.W)) analyze(laplacian.W);
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
    std::ostringstream text;
    text << "the LDL^T factorization of W - sigma D meets a zero pivot at sigma = " << sigma;
    throw SolverFailure(text.str());
}

void ShiftedLdlt::analyze(const SparseMatrix& W) {
    shifted_.resize(0, 0);  // of another pattern, even if this one cannot be used
    ldlt_.analyzePattern(W);
    if (ldlt_.entries() > std::numeric_limits<int>::max())
        throw InvalidMesh("the factorization of W - sigma D (" + std::to_string(W.rows()) +
                          " vertices) has too many entries, " + std::to_string(ldlt_.entries()) +
                          ": apply 'Simplification: Quadric Edge Collapse Decimation' first");
}

Eigen::MatrixXd ShiftedLdlt::solve(const Eigen::MatrixXd& B) const {
    Eigen::MatrixXd X = B;
    applyResolvent(Eigen::VectorXd::Ones(B.rows()), X);
    return X;
}

void ShiftedLdlt::applyResolvent(const Eigen::VectorXd& D, Eigen::Ref<Eigen::MatrixXd> U,
                                 double root) const {
    const SparseMatrix& L = ldlt_.matrixL().nestedExpression();
    const LdltFactor factor{L.rows(),     L.outerIndexPtr(), L.innerIndexPtr(),
                            L.valuePtr(), pivots_.data(),    ldlt_.permutationP().indices().data()};
    assert(U.outerStride() == U.rows());
    triangularSolves().apply(factor, D.data(), root, U.data(), U.cols());
}

}  // namespace spectral
