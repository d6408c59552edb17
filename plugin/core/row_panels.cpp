#include "row_panels.h"

#include <algorithm>

namespace spectral {

namespace {

constexpr Index kRows = 256;

}  // namespace

RowPanels::RowPanels(const Laplacian& laplacian, const std::vector<int>& order, Index begin,
                     Index end) {
    const SparseMatrix& W = laplacian.W;
    std::vector<int> position(order.size(), -1);  // of a row among those that the panel needs
    const auto need = [&](int row) {
        if (position[row] < 0) {
            position[row] = static_cast<int>(rows_.size() - places_.back().rows);
            rows_.push_back(row);
        }
        return position[row];
    };
    for (Index first = begin; first < end; first += kRows) {
        places_.push_back(next());
        std::vector<int> own(order.begin() + first, order.begin() + std::min(first + kRows, end));
        std::sort(own.begin(), own.end());  // as they lie in memory
        for (const int row : own) need(row);
        starts_.push_back(0);
        for (const int row : own) {
            // As W is symmetric its columns serve as rows.
            for (SparseMatrix::InnerIterator entry(W, row); entry; ++entry) {
                columns_.push_back(need(static_cast<int>(entry.row())));
                values_.push_back(entry.value());
            }
            starts_.push_back(static_cast<int>(columns_.size() - places_.back().entries));
            masses_.push_back(laplacian.D[row]);
        }
        for (auto row = rows_.begin() + places_.back().rows; row != rows_.end(); ++row)
            position[*row] = -1;
    }
    places_.push_back(next());
}

std::vector<RowPanel> RowPanels::panels() const {
    std::vector<RowPanel> panels;
    for (std::size_t i = 0; i + 1 < places_.size(); ++i) {
        const Place &at = places_[i], &next = places_[i + 1];
        panels.push_back({static_cast<Index>(next.masses - at.masses),
                          static_cast<Index>(next.rows - at.rows), &rows_[at.rows],
                          &starts_[at.starts], &columns_[at.entries], &values_[at.entries],
                          &masses_[at.masses]});
    }
    return panels;
}

}  // namespace spectral
