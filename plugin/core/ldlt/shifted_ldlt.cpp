#include "core/ldlt/shifted_ldlt.h"

#include <algorithm>
#include <sstream>
#include <string>

#include "core/ldlt/kernels.h"
#include "core/support/errors.h"
#include "core/support/memory.h"
#include "core/support/threads.h"

namespace spectral {

namespace {

constexpr int kMaxAttempts = 4;

/// Memory for the analysis and the factor of a mesh, bytes per row.
constexpr double kBytesPerRow = 1000.0;

/// Size of pending contribution blocks, relative to the factor.
constexpr double kPendingBlocks = 0.3;
/// Number of Krylov vectors, of three columns each.
constexpr double kVectors = 15.0;

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Relative perturbation of a shift that is an eigenvalue of a leading minor: far above round-off,
/// far below the spacing of eigenvalues.
constexpr double kPerturbation = 1e-7;

}  // namespace

void ShiftedLdlt::analyze(const SparseMatrix& W, const SymbolicLdlt* similar) {
    if (analysis_ && analysis_->hasPatternOf(W)) return;
    if (!analysis_) requireMemory(kBytesPerRow * static_cast<double>(W.rows()), W.rows());
    analysis_ = std::make_shared<const SymbolicLdlt>(W, similar);
}

ShiftedLdlt ShiftedLdlt::sibling(const SparseMatrix& W) {
    analyze(W, nullptr);  // hundreds of solves follow: worth finding the best order
    ShiftedLdlt empty;
    empty.analysis_ = analysis_;
    return empty;
}

void ShiftedLdlt::factorize(const SparseMatrix& W, const Eigen::VectorXd& D, double sigma,
                            const StopPoint& stop) {
    analyze(W, analysis_.get());
    symbolic_ = analysis_;
    if (numbers_.values.empty())
        requireMemory(sizeof(double) * ((1.0 + kPendingBlocks) * symbolic_->valueStarts.back() +
                                        3.0 * kVectors * static_cast<double>(W.rows())),
                      W.rows());
    ++factorizations_;
    for (int attempt = 0; attempt < kMaxAttempts; ++attempt) {
        shift_ = sigma * (1.0 + attempt * kPerturbation);
        if (!eliminate(*symbolic_, W, D, shift_, numbers_, stop)) continue;
        if (!numbers_.pivots.allFinite()) continue;
        below_ = (numbers_.pivots.array() < 0.0).count();
        return;
    }
    std::ostringstream text;
    text << "the LDL^T factorization of W - sigma D (" << W.rows()
         << " rows) hits a zero pivot at sigma = " << sigma;
    throw SolverFailure(ErrorCode::SingularMatrix, text.str());
}

void ShiftedLdlt::factorizeDefinite(const SparseMatrix& W, const Eigen::VectorXd& D, double shift,
                                    const StopPoint& stop) {
    factorize(W, D, -shift, stop);
    if (below_ > 0)
        throw SolverFailure(ErrorCode::SingularMatrix,
                            "W + s D (" + std::to_string(W.rows()) +
                                " rows) is not positive definite to working precision");
}

Index countEigenvaluesBelow(const SparseMatrix& W, const Eigen::VectorXd& D, double sigma,
                            ShiftedLdlt& ldlt) {
    ShiftedLdlt sibling = ldlt.sibling(W);
    sibling.factorize(W, D, sigma);
    ldlt.addWork(sibling);
    return sibling.eigenvaluesBelow();
}

Eigen::MatrixXd ShiftedLdlt::solve(const Eigen::MatrixXd& B) const {
    Eigen::MatrixXd X = B;
    applyResolvent(Eigen::VectorXd::Ones(B.rows()), X);
    return X;
}

void ShiftedLdlt::applyResolvent(const Eigen::VectorXd& D, Eigen::Ref<Eigen::MatrixXd> U) const {
    // The factor is far larger than the cache: each pass over it serves several columns.
    const Eigen::VectorXi& order = symbolic_->order;
    std::vector<double> ordered(static_cast<std::size_t>(orderedRows() * kMaxRightHandSides));
    int columns = 0;
    for (Index first = 0; first < U.cols(); first += columns) {
        const Index left = U.cols() - first;
        columns = left >= kMaxRightHandSides ? kMaxRightHandSides
                                             : static_cast<int>(std::min<Index>(left, 4));
        Eigen::Map<RowMajorMatrix> Y(ordered.data(), orderedRows(), columns);
        for (Index i = 0; i < U.rows(); ++i)
            Y.row(order[i]) = D[i] * U.row(i).segment(first, columns);
        solveOrdered(ordered.data(), columns);
        for (Index i = 0; i < U.rows(); ++i) U.row(i).segment(first, columns) = Y.row(order[i]);
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

    // L Z = Y: the subtrees, each on its own rows and its copies of shared ones, then the rest.
    rows.bottomRows(orderedRows() - n).setZero();
    parallelFor(count, [&](Index task) {
        const SymbolicLdlt::Subtree& tree = subtrees[symbolic.largestFirst[task]];
        kernels().forward(factor, Y, columns, tree.firstColumn, tree.endColumn);
        divideByPivots(tree.firstColumn, tree.endColumn);
    });
    for (std::size_t k = 0; k < symbolic.copied.size(); ++k)
        rows.row(symbolic.copied[k]) += rows.row(n + static_cast<Index>(k));
    Index next = 0;
    for (const SymbolicLdlt::Subtree& tree : subtrees) {
        kernels().forward(factor, Y, columns, next, tree.firstColumn);
        divideByPivots(next, tree.firstColumn);
        next = tree.endColumn;
    }
    kernels().forward(factor, Y, columns, next, n);
    divideByPivots(next, n);

    // L^T X = Z, in reverse order.
    Index end = n;
    for (Index t = count - 1; t >= 0; --t) {
        kernels().backward(factor, Y, columns, subtrees[t].endColumn, end);
        end = subtrees[t].firstColumn;
    }
    kernels().backward(factor, Y, columns, 0, end);
    for (std::size_t k = 0; k < symbolic.copied.size(); ++k)
        rows.row(n + static_cast<Index>(k)) = rows.row(symbolic.copied[k]);
    parallelFor(count, [&](Index task) {
        const SymbolicLdlt::Subtree& tree = subtrees[symbolic.largestFirst[task]];
        kernels().backward(factor, Y, columns, tree.firstColumn, tree.endColumn);
    });
}

}  // namespace spectral
