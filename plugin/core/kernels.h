#pragma once

#include <vector>

#include "dense_eigenproblems.h"
#include "dense_products.h"
#include "front_elimination.h"
#include "panel_products.h"
#include "sparse_products.h"
#include "triangular_solves.h"

namespace spectral {

/// What is compiled once for each instruction set.
struct Kernels {
    const DenseProducts& dense;
    const DenseEigenproblems& eigen;
    const FrontElimination& fronts;
    const PanelProducts& panels;
    const SparseProducts& sparse;
    const TriangularSolves& triangular;
};

/// Those that this processor can run, the one with the widest vectors first: denseProducts() and
/// the like are of that one.
const std::vector<Kernels>& availableKernels();

}  // namespace spectral
