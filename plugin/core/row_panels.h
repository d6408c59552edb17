#pragma once

#include <vector>

#include "laplacian.h"
#include "panel_products.h"
#include "types.h"

namespace spectral {

/// Some rows of W and D in panels: so few rows each that what belongs to them stays in the cache.
class RowPanels {
  public:
    /// @param order       n: the rows of W, neighbours mostly close to each other, so that a panel
    ///                    needs few rows beside its own.
    /// @param begin, end  what is taken of this order.
    RowPanels(const Laplacian& laplacian, const std::vector<int>& order, Index begin, Index end);

    /// What they point to is kept here.
    std::vector<RowPanel> panels() const;

  private:
    /// Where the data of a panel begin.
    struct Place {
        std::size_t rows = 0, starts = 0, entries = 0, masses = 0;
    };
    Place next() const { return {rows_.size(), starts_.size(), columns_.size(), masses_.size()}; }

    std::vector<Place> places_;  // of the panels, and where the next one would begin
    std::vector<int> rows_, starts_, columns_;
    std::vector<double> values_, masses_;
};

}  // namespace spectral
