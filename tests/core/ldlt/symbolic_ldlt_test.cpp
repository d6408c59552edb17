#include "core/ldlt/symbolic_ldlt.h"

#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <vector>

#include "support/evaluation.h"
#include "support/shapes.h"

namespace spectral {
namespace {

using testing::Operator;
using Natural = Eigen::NaturalOrdering<int>;

std::vector<SparseMatrix> patterns() {
    std::vector<SparseMatrix> all;
    for (const auto& mesh :
         {testing::icosphere(0), testing::icosphere(3), testing::rectangle(2.0, 1.0, 23, 9),
          testing::joined(testing::torus(2.0, 1.0, 17, 9), testing::cube(3))})
        all.push_back(Operator(mesh).laplacian.W);
    SparseMatrix diagonal(5, 5);
    diagonal.setIdentity();
    all.push_back(diagonal);
    return all;
}

/// Eigen's factor of a positive definite matrix with the pattern of W, in this order.
SparseMatrix factorOf(const SparseMatrix& W, const Eigen::VectorXi& order) {
    SparseMatrix positive = W, reordered(W.rows(), W.cols());
    positive.diagonal().array() += 1.0;
    const Eigen::PermutationMatrix<Eigen::Dynamic> P(order);
    reordered.selfadjointView<Eigen::Lower>() =
        positive.selfadjointView<Eigen::Lower>().twistedBy(P);
    const Eigen::SimplicialLDLT<SparseMatrix, Eigen::Lower, Natural> ldlt(reordered);
    return ldlt.matrixL().nestedExpression();
}

std::vector<int> rowsOfColumn(const SymbolicLdlt& symbolic, Index column) {
    const auto begin = symbolic.frontRows.begin() + symbolic.rowStarts[column];
    return {begin, begin + symbolic.valueStarts[column + 1] - symbolic.valueStarts[column]};
}

/// Rows of the factor that a front has.
std::vector<int> rowsOf(const SymbolicLdlt& symbolic, const SymbolicLdlt::Front& front) {
    const auto begin = symbolic.frontRows.begin() + front.firstRow;
    return {begin, begin + front.width + front.below};
}

TEST(SymbolicLdlt, HasTheRowsOfEigensFactorAndFewZeros) {
    for (const SparseMatrix& W : patterns()) {
        const SymbolicLdlt symbolic(W);
        const SparseMatrix L = factorOf(W, symbolic.order);
        for (Index j = 0; j < W.cols(); ++j) {
            const std::vector<int> rows = rowsOfColumn(symbolic, j);
            const int *begin = L.innerIndexPtr() + L.outerIndexPtr()[j],
                      *end = L.innerIndexPtr() + L.outerIndexPtr()[j + 1];
            EXPECT_TRUE(std::includes(rows.begin(), rows.end(), begin, end)) << j;
            EXPECT_TRUE(std::is_sorted(rows.begin(), rows.end())) << j;
            if (!symbolic.joined[j]) {
                EXPECT_EQ(rows, std::vector<int>(begin, end)) << j;
            }
        }
        EXPECT_LE(symbolic.valueStarts.back(), 1.3 * static_cast<double>(L.nonZeros()));
    }
}

TEST(SymbolicLdlt, JoinsColumnsThatHaveTheSameRowsBelow) {
    for (const SparseMatrix& W : patterns()) {
        const SymbolicLdlt symbolic(W);
        for (Index j = 0; j < W.cols(); ++j) {
            if (!symbolic.joined[j]) continue;
            std::vector<int> next = rowsOfColumn(symbolic, j + 1);
            next.insert(next.begin(), static_cast<int>(j + 1));
            EXPECT_EQ(rowsOfColumn(symbolic, j), next);
        }
    }
}

TEST(SymbolicLdlt, FrontsTakeAllColumnsAndTheirChildrensRows) {
    for (const SparseMatrix& W : patterns()) {
        const SymbolicLdlt symbolic(W);
        int next = 0;
        std::vector<const SymbolicLdlt::Front*> waiting;
        for (const SymbolicLdlt::Front& front : symbolic.fronts) {
            EXPECT_EQ(front.first, next);
            next += front.width;
            const std::vector<int> rows = rowsOf(symbolic, front);
            ASSERT_EQ(static_cast<int>(rows.size()), front.width + front.below);
            ASSERT_LE(front.children, static_cast<int>(waiting.size()));
            for (int i = 0; i < front.children; ++i, waiting.pop_back()) {
                const SymbolicLdlt::Front& child = *waiting.back();
                const std::vector<int> below = rowsOf(symbolic, child);
                for (int r = 0; r < child.below; ++r)
                    EXPECT_EQ(rows[symbolic.places[child.firstPlace + r]], below[child.width + r]);
            }
            if (front.below > 0) waiting.push_back(&front);
        }
        EXPECT_EQ(next, W.rows());
        EXPECT_TRUE(waiting.empty());
    }
}

TEST(SymbolicLdlt, PutsEveryEntryOfTheLowerHalfIntoAFront) {
    for (const SparseMatrix& W : patterns()) {
        const SymbolicLdlt symbolic(W);
        EXPECT_EQ(static_cast<Index>(symbolic.entries.size()), (W.nonZeros() + W.rows()) / 2);
        for (const SymbolicLdlt::Front& front : symbolic.fronts) {
            const std::vector<int> rows = rowsOf(symbolic, front);
            for (int e = front.entriesBegin; e < front.entriesEnd; ++e) {
                const SymbolicLdlt::Entry& entry = symbolic.entries[e];
                const int row = symbolic.order[W.innerIndexPtr()[entry.source]];
                const int* start = W.outerIndexPtr();
                const auto column =
                    std::upper_bound(start, start + W.cols() + 1, entry.source) - start - 1;
                EXPECT_EQ(rows[entry.row], row);
                EXPECT_EQ(rows[entry.column], symbolic.order[column]);
                EXPECT_LE(symbolic.order[column], row);
            }
        }
    }
}

}  // namespace
}  // namespace spectral
