#pragma once

#include <vector>

#include "core/kernels/front_elimination.h"
#include "core/kernels/triangular_solves.h"

namespace spectral {

/// What is compiled once for each instruction set, with SPECTRAL_INSTRUCTIONS for the namespace of
/// the result. All of Eigen is then in a namespace of its own, too (-DEigen=...): its templates are
/// compiled with other instructions there than elsewhere, and the linker must not take the one for
/// the other. So pointers cross between them, not Eigen's types.
struct Kernels {
    const FrontElimination& fronts;
    const TriangularSolves& triangular;
};

/// Those that this processor can run, the one with the widest vectors first: frontElimination() and
/// triangularSolves() are of that one.
const std::vector<Kernels>& availableKernels();

}  // namespace spectral
