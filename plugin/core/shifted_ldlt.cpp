#include "shifted_ldlt.h"

#include <cassert>
#include <sstream>

#include "errors.h"
#include "triangular_solves.h"

namespace spectral {

namespace {

constexpr int kMaxAttempts = 4;

/// Relative change of a shift that has met an eigenvalue of a leading minor.
constexpr double kNudge = 1e-7;

}  // namespace

void ShiftedLdlt::analyze(const Laplacian& laplacian) {
    if (!symbolic_.isOf(laplacian.W)) symbolic_ = SymbolicLdlt(laplacian.W);
}

const std::vector<int>& ShiftedLdlt::order(const Laplacian& laplacian) {
    analyze(laplacian);
    return symbolic_.inverse;
}

void ShiftedLdlt::factorize(const Laplacian& laplacian, double sigma) {
    analyze(laplacian);
    for (int attempt = 0; attempt < kMaxAttempts; ++attempt) {
        shift_ = sigma * (1.0 + attempt * kNudge);
        if (!eliminate(symbolic_, laplacian, shift_, numbers_)) continue;
        if (!numbers_.pivots.allFinite()) continue;
        below_ = (numbers_.pivots.array() < 0.0).count();
        return;
    }
    std::ostringstream text;
    text << "the LDL^T factorization of W - sigma D meets a zero pivot at sigma = " << sigma;
    throw SolverFailure(text.str());
}

Eigen::MatrixXd ShiftedLdlt::solve(const Eigen::MatrixXd& B) const {
    Eigen::MatrixXd X = B;
    applyResolvent(Eigen::VectorXd::Ones(B.rows()), X);
    return X;
}

void ShiftedLdlt::applyResolvent(const Eigen::VectorXd& D, Eigen::Ref<Eigen::MatrixXd> U,
                                 double root) const {
    const LdltFactor factor{symbolic_.order.size(),     symbolic_.valueStarts.data(),
                            symbolic_.rowStarts.data(), symbolic_.frontRows.data(),
                            numbers_.values.data(),     numbers_.pivots.data(),
                            symbolic_.joined.data(),    symbolic_.order.data()};
    assert(U.outerStride() == U.rows());
    triangularSolves().apply(factor, D.data(), root, U.data(), U.cols());
}

}  // namespace spectral
