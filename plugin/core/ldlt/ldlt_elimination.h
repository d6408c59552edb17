#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/ldlt/symbolic_ldlt.h"
#include "core/support/threads.h"

namespace spectral {

/// P (W - sigma D) P^T = L diag(pivots) L^T. L has a diagonal of ones, which is not stored; the
/// values of its columns begin at SymbolicLdlt::valueStarts.
struct LdltNumbers {
    std::vector<double> values;
    Eigen::VectorXd pivots;
};

/// Factorizes without pivoting, each supernode in a dense frontal matrix whose contribution block
/// is added to that of its parent (the multifrontal method: Duff and Reid 1983; Davis, Direct
/// Methods for Sparse Linear Systems, 2006, section 11).
///
/// @param symbolic  of the pattern of W.
/// @param numbers   its memory is reused.
/// @param stop      called every now and then on the caller's thread; may throw. May be empty.
/// @return false when a pivot is 0: the numbers are then meaningless. They may be infinite.
bool eliminate(const SymbolicLdlt& symbolic, const SparseMatrix& W, const Eigen::VectorXd& D,
               double sigma, LdltNumbers& numbers, const StopPoint& stop);

}  // namespace spectral
