#include "core/ldlt/shifted_ldlt.h"

#include <algorithm>
#include <sstream>

#include "core/kernels/triangular_solves.h"
#include "core/support/errors.h"
#include "core/support/thread_team.h"

namespace spectral {

namespace {

constexpr int kMaxAttempts = 4;

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Relative change of a shift that has met an eigenvalue of a leading minor.
constexpr double kNudge = 1e-7;

}  // namespace

const std::shared_ptr<const SymbolicLdlt>& ShiftedLdlt::analysis(const Laplacian& laplacian) {
    if (!analysis_ || !analysis_->isOf(laplacian.W))
        analysis_ = std::make_shared<const SymbolicLdlt>(laplacian.W);
    return analysis_;
}

void ShiftedLdlt::factorize(const Laplacian& laplacian, double sigma) {
    symbolic_ = analysis(laplacian);
    ++factorizations_;
    for (int attempt = 0; attempt < kMaxAttempts; ++attempt) {
        shift_ = sigma * (1.0 + attempt * kNudge);
        if (!eliminate(*symbolic_, laplacian, shift_, numbers_)) continue;
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
    // The factor is far larger than the cache: each pass over it serves as many columns as it can.
    // A few more than there are cost less than one pass more.
    const Eigen::VectorXi& order = symbolic_->order;
    std::vector<double> ordered;
    for (Index first = 0; first < U.cols(); first += kMostRightHandSides) {
        const auto used = static_cast<int>(std::min<Index>(kMostRightHandSides, U.cols() - first));
        const int columns = used <= 4 ? used : used <= 8 ? 8 : kMostRightHandSides;
        ordered.assign(static_cast<std::size_t>(orderedRows() * columns), 0.0);
        Eigen::Map<RowMajorMatrix> Y(ordered.data(), orderedRows(), columns);
        for (Index i = 0; i < U.rows(); ++i)
            Y.row(order[i]).head(used) = D[i] * U.row(i).segment(first, used);
        solveOrdered(ordered.data(), columns);
        solves_ -= columns - used;  // columns that nobody has asked for
        for (Index i = 0; i < U.rows(); ++i)
            U.row(i).segment(first, used) =
                Y.row(order[i]).head(used) - root * U.row(i).segment(first, used);
    }
}

void ShiftedLdlt::solveOrdered(double* Y, int columns) const {
    const SymbolicLdlt& symbolic = *symbolic_;
    const LdltFactor factor{symbolic.valueStarts.data(), symbolic.rowStarts.data(),
                            symbolic.solveRows.data(), numbers_.values.data(),
                            symbolic.joined.data()};
    const Index n = symbolic.order.size();
    const std::vector<SymbolicLdlt::Subtree>& subtrees = symbolic.subtrees;
    solves_ += columns;
    const auto count = static_cast<Index>(subtrees.size());
    const auto rowsOf = [&](double* rows) {
        return Eigen::Map<RowMajorMatrix>(rows, orderedRows(), columns);
    };
    auto rows = rowsOf(Y);
    const auto divideByPivots = [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) rows.row(i) /= numbers_.pivots[i];
    };

    // L Z = Y: the subtrees, each on its own rows and its copies of others', then what is above.
    rows.bottomRows(orderedRows() - n).setZero();
    parallelFor(count, [&](Index t) {
        triangularSolves().eliminate(factor, Y, columns, subtrees[t].firstColumn,
                                     subtrees[t].endColumn);
        divideByPivots(subtrees[t].firstColumn, subtrees[t].endColumn);
    });
    for (std::size_t k = 0; k < symbolic.copied.size(); ++k)
        rows.row(symbolic.copied[k]) += rows.row(n + static_cast<Index>(k));
    Index next = 0;
    for (const SymbolicLdlt::Subtree& tree : subtrees) {
        triangularSolves().eliminate(factor, Y, columns, next, tree.firstColumn);
        divideByPivots(next, tree.firstColumn);
        next = tree.endColumn;
    }
    triangularSolves().eliminate(factor, Y, columns, next, n);
    divideByPivots(next, n);

    // L^T X = Z, the other way round.
    Index end = n;
    for (Index t = count - 1; t >= 0; --t) {
        triangularSolves().substitute(factor, Y, columns, subtrees[t].endColumn, end);
        end = subtrees[t].firstColumn;
    }
    triangularSolves().substitute(factor, Y, columns, 0, end);
    for (std::size_t k = 0; k < symbolic.copied.size(); ++k)
        rows.row(n + static_cast<Index>(k)) = rows.row(symbolic.copied[k]);
    parallelFor(count, [&](Index t) {
        triangularSolves().substitute(factor, Y, columns, subtrees[t].firstColumn,
                                      subtrees[t].endColumn);
    });
}

}  // namespace spectral
