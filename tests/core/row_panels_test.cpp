#include "core/row_panels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "core/shifted_ldlt.h"
#include "support/evaluation.h"
#include "support/shapes.h"

namespace spectral {
namespace {

std::vector<int> shuffled(Index n, unsigned seed) {
    std::vector<int> order(static_cast<std::size_t>(n));
    std::iota(order.begin(), order.end(), 0);
    std::mt19937 generator(seed);
    // Not std::shuffle, whose result is another in every standard library.
    for (std::size_t i = order.size() - 1; i > 0; --i)
        std::swap(order[i], order[generator() % (i + 1)]);
    return order;
}

/// Rows of S that the panels need, in all.
Index neededRows(const Laplacian& laplacian, const std::vector<int>& order) {
    const RowPanels rows(laplacian, order, 0, laplacian.D.size());
    Index needed = 0;
    for (const RowPanel& panel : rows.panels()) needed += panel.needed;
    return needed;
}

TEST(RowPanels, HoldEveryRowOfWAndDOnce) {
    const testing::Operator A(testing::icosphere(3));
    const Index n = A.laplacian.D.size();
    const std::vector<int> order = shuffled(n, 3);
    Eigen::MatrixXd W = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd D = Eigen::VectorXd::Zero(n);
    for (const auto& [begin, end] : {std::pair<Index, Index>{0, 300}, {300, n}}) {
        const RowPanels rows(A.laplacian, order, begin, end);
        for (const RowPanel& panel : rows.panels()) {
            ASSERT_LE(panel.count, panel.needed);
            for (Index i = 0; i < panel.count; ++i) {
                const int row = panel.rows[i];
                D[row] += panel.masses[i];
                for (int p = panel.starts[i]; p < panel.starts[i + 1]; ++p) {
                    ASSERT_LT(panel.columns[p], panel.needed);
                    W(row, panel.rows[panel.columns[p]]) += panel.values[p];
                }
            }
        }
    }
    EXPECT_EQ(D, A.laplacian.D);
    EXPECT_EQ(W, Eigen::MatrixXd(A.laplacian.W));
}

TEST(RowPanels, OfNoRowsAreNone) {
    const testing::Operator A(testing::icosphere(0));
    EXPECT_TRUE(RowPanels(A.laplacian, shuffled(12, 1), 5, 5).panels().empty());
}

TEST(RowPanels, NeedFewRowsBesideTheirOwnInTheOrderOfAFactorization) {
    const testing::Operator A(testing::icosphere(5));
    const Index n = A.laplacian.D.size();
    ShiftedLdlt factor;
    EXPECT_LT(neededRows(A.laplacian, factor.order(A.laplacian)), 2 * n);
    EXPECT_GT(neededRows(A.laplacian, shuffled(n, 2)), 6 * n);
}

}  // namespace
}  // namespace spectral
