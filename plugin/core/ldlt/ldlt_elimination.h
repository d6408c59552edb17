#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/ldlt/symbolic_ldlt.h"
#include "core/support/threads.h"

namespace spectral {

/// P (W - sigma D) P^T = L diag(pivots) L^T. The unit diagonal of L is not stored; the values of
/// its columns start at SymbolicLdlt::valueStarts.
struct LdltNumbers {
    std::vector<double> values;
    Eigen::VectorXd pivots;

    /// Frontal matrices, by thread: fresh memory for every factorization would take a tenth of it.
    struct Workspace {
        Eigen::VectorXd columns, scratch, stack;
    };
    std::vector<Workspace> workspaces;
};

/// Factorizes without pivoting, each supernode in a dense frontal matrix whose contribution block
/// is added to that of its parent (the multifrontal method: Duff and Reid 1983; Davis, Direct
/// Methods for Sparse Linear Systems, 2006, section 11).
///
/// @param symbolic  symbolic analysis of the pattern of W.
/// @param numbers   the result; its memory is reused. Entries may be infinite.
/// @param stop      called now and then on the caller's thread; may throw. May be empty.
/// @return false when a pivot is 0: the numbers are then meaningless.
bool eliminate(const SymbolicLdlt& symbolic, const SparseMatrix& W, const Eigen::VectorXd& D,
               double sigma, LdltNumbers& numbers, const StopPoint& stop);

}  // namespace spectral
