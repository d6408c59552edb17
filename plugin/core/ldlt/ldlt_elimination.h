#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/laplacian/laplacian.h"
#include "core/ldlt/symbolic_ldlt.h"

namespace spectral {

/// P (W - sigma D) P^T = L diag(pivots) L^T. L has a diagonal of ones, which is not stored; the
/// values of its columns begin at SymbolicLdlt::valueStarts.
struct LdltNumbers {
    std::vector<double> values;
    Eigen::VectorXd pivots;
};

/// Eliminates without pivoting, supernode by supernode, each in a dense front (the multifrontal
/// method: Duff and Reid 1983; Davis, Direct Methods for Sparse Linear Systems, 2006, section 11).
/// What a front leaves in the rows below its columns is added to the front of its parent.
///
/// @param symbolic  of laplacian.W.
/// @param numbers   keeps its memory from call to call.
/// @return whether no pivot is 0, else the numbers have no meaning. They may be infinite.
bool eliminate(const SymbolicLdlt& symbolic, const Laplacian& laplacian, double sigma,
               LdltNumbers& numbers);

}  // namespace spectral
