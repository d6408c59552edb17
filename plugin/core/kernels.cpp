// Compiled once for each instruction set, as dense_products.cpp is: see there.
#include "kernels.h"

namespace spectral::SPECTRAL_INSTRUCTIONS {

extern const DenseProducts denseProducts;
extern const DenseEigenproblems denseEigenproblems;
extern const FrontElimination frontElimination;
extern const PanelProducts panelProducts;
extern const SparseProducts sparseProducts;
extern const TriangularSolves triangularSolves;

extern const Kernels kernels;
const Kernels kernels{denseProducts, denseEigenproblems, frontElimination,
                      panelProducts, sparseProducts,     triangularSolves};

}  // namespace spectral::SPECTRAL_INSTRUCTIONS
