// Compiled once for each instruction set, as dense_products.cpp is: see there.
#include "panel_products.h"

#include <Eigen/Core>
#include <algorithm>

namespace spectral {

namespace {

using Size = std::ptrdiff_t;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Square = Eigen::Map<Eigen::MatrixXd>;

/// Columns of S that are taken at once, side by side: a row of them is two lines of the cache.
constexpr int kColumns = 16;

/// Of them, those that are copied at once: more columns are more pages of memory.
constexpr int kCopied = 8;

/// The rows of S that a panel needs, some of their columns: each row in one piece.
using Rows = Eigen::Array<double, kColumns, Eigen::Dynamic>;

/// @param S  the first of `columns` columns, at most kColumns.
void copyRows(const RowPanel& panel, const double* S, Size n, Size columns, Rows& rows) {
    if (columns < kColumns) rows.setZero();
    for (Size first = 0; first < columns; first += kCopied) {
        const double* block = S + first * n;
        if (columns - first >= kCopied) {
            for (Size i = 0; i < panel.needed; ++i)
                for (int j = 0; j < kCopied; ++j) rows(first + j, i) = block[panel.rows[i] + j * n];
            continue;
        }
        for (Size i = 0; i < panel.needed; ++i)
            for (Size j = 0; first + j < columns; ++j)
                rows(first + j, i) = block[panel.rows[i] + j * n];
    }
}

void add(const RowPanel* panels, Size panelCount, const double* S, Size n, Size m, double* H,
         double* G) {
    Size count = 0, needed = 0;
    for (Size i = 0; i < panelCount; ++i) {
        count = std::max(count, panels[i].count);
        needed = std::max(needed, panels[i].needed);
    }
    const Size padded = (m + kColumns - 1) / kColumns * kColumns;
    Rows rows(kColumns, needed);
    RowMajor own(count, padded), product(count, padded);  // S_P; (W S)_P, then D_P S_P
    for (const RowPanel* panel = panels; panel != panels + panelCount; ++panel) {
        for (Size first = 0; first < m; first += kColumns) {
            copyRows(*panel, S + first * n, n, std::min<Size>(kColumns, m - first), rows);
            for (Size i = 0; i < panel->count; ++i) {
                Eigen::Array<double, kColumns, 1> sum = Eigen::Array<double, kColumns, 1>::Zero();
                for (int p = panel->starts[i]; p < panel->starts[i + 1]; ++p)
                    sum += panel->values[p] * rows.col(panel->columns[p]);
                product.row(i).segment<kColumns>(first) = sum.matrix();
                own.row(i).segment<kColumns>(first) = rows.col(i).matrix();
            }
        }
        const auto s = own.topLeftCorner(panel->count, m);
        auto p = product.topLeftCorner(panel->count, m);
        Square(H, m, m).triangularView<Eigen::Upper>() += s.transpose() * p;
        for (Size i = 0; i < panel->count; ++i) p.row(i) = panel->masses[i] * s.row(i);
        Square(G, m, m).triangularView<Eigen::Upper>() += s.transpose() * p;
    }
}

}  // namespace

namespace SPECTRAL_INSTRUCTIONS {
extern const PanelProducts panelProducts;
const PanelProducts panelProducts{add};
}  // namespace SPECTRAL_INSTRUCTIONS

}  // namespace spectral
