#pragma once

#include <cstddef>

namespace spectral {

/// Some rows of the symmetric sparse W and of the masses D as they lie in memory: the rows of a
/// panel, and those of S that W takes for them.
struct RowPanel {
    std::ptrdiff_t count = 0;     ///< Of the rows of the panel.
    std::ptrdiff_t needed = 0;    ///< Of the rows of S that W has entries for, and the panel's own.
    const int* rows = nullptr;    ///< needed: which of S they are, those of the panel first.
    const int* starts = nullptr;  ///< count + 1: where rows of W begin in the next two.
    const int* columns = nullptr;    ///< Places in `rows`.
    const double* values = nullptr;  ///< Entries of W.
    const double* masses = nullptr;  ///< count: of D.
};

/// The matrices of the Rayleigh-Ritz procedure in one pass over S, for the widest vector
/// instructions that the processor has. Pointers, not Eigen's types: see dense_products.cpp.
struct PanelProducts {
    /// H += the upper half of S^T W S, and G += that of S^T D S, as far as the rows of the panels
    /// contribute: S_P^T (W S)_P and S_P^T D_P S_P.
    ///
    /// Column-major, without gaps: S n x m, H and G m x m.
    void (*add)(const RowPanel* panels, std::ptrdiff_t panelCount, const double* S,
                std::ptrdiff_t n, std::ptrdiff_t m, double* H, double* G);
};

/// Chosen for this processor, once.
const PanelProducts& panelProducts();

}  // namespace spectral
