// Compiled once for each instruction set: see kernels.h.
#include "core/kernels/kernels.h"

namespace spectral::SPECTRAL_INSTRUCTIONS {

extern const FrontElimination frontElimination;
extern const TriangularSolves triangularSolves;

extern const Kernels kernels;
const Kernels kernels{frontElimination, triangularSolves};

}  // namespace spectral::SPECTRAL_INSTRUCTIONS
