#pragma once

#include <Eigen/Core>
#include <vector>

#include "laplacian.h"
#include "symbolic_ldlt.h"

namespace spectral {

/// P (W - sigma D) P^T = L diag(pivots) L^T. L has a diagonal of ones, which is not stored; its
/// columns begin at SymbolicLdlt::factorStarts, their rows ascend.
struct LdltNumbers {
    std::vector<int> rows;
    std::vector<double> values;
    Eigen::VectorXd pivots;
};

/// Eliminates without pivoting, row by row of L ("up-looking": Davis, Direct Methods for Sparse
/// Linear Systems, 2006, section 4.8), and up to four columns of one supernode at once.
///
/// @param symbolic  of laplacian.W.
/// @param numbers   keeps its memory from call to call.
/// @return whether no pivot is 0, else the numbers have no meaning. They may be infinite.
bool eliminate(const SymbolicLdlt& symbolic, const Laplacian& laplacian, double sigma,
               LdltNumbers& numbers);

}  // namespace spectral
