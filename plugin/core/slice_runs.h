#pragma once

#include <Eigen/Core>
#include <vector>

#include "components.h"
#include "laplacian.h"
#include "pair_store.h"
#include "progress.h"
#include "shifted_ldlt.h"
#include "types.h"

namespace spectral {

/// Where the slices of two runs meet: at `lambda`, or in the widest gap between eigenvalues within
/// `window` of it, so that no group of equal ones is torn apart. Both runs find these eigenvalues
/// and, each for itself, the same gap.
struct SliceEdge {
    double lambda = 0.0;
    double window = 0.0;
};

/// What a run is to find: the eigenpairs between two edges, from a shift between them.
struct SliceTask {
    double sigma = 0.0;
    SliceEdge from, to;
    Eigen::Ref<const Eigen::MatrixXd> known;  ///< D-orthonormal vectors not to be found again.
    Index missing = 0;  ///< Pairs that are known to be there: as long as the space may grow, the
                        ///< run does not end before it has so many.
    unsigned seed = 0;  ///< Of the start vector; another for each run.
};

/// What a run has found. Its pairs are in the store.
struct SliceRun {
    double sigma = 0.0;
    Index below = 0;  ///< Eigenvalues below sigma, by inertia.
    int solves = 0;

    // Converged pairs cover the part of the slice between these; it is the whole slice unless the
    // space became too large.
    double coveredFrom = 0.0, coveredTo = 0.0;
    bool reachedFrom = true, reachedTo = true;
};

/// Does runs on all cores.
class SliceWorkers {
  public:
    /// The arguments are kept by reference.
    SliceWorkers(const Laplacian& laplacian, const ConstantModes& constants);

    /// Numbers of eigenvalues below these shifts, by inertia.
    std::vector<Index> count(const std::vector<double>& sigmas, const Progress& progress);

    /// Does the tasks; the results are in their order and do not depend on the number of cores.
    /// @throws SolverFailure  of any run; Cancelled.
    std::vector<SliceRun> execute(const std::vector<SliceTask>& tasks, PairStore& found,
                                  const Progress& progress);

  private:
    /// Storage that a worker uses again from run to run.
    struct Workspace {
        ShiftedLdlt factor;
        Eigen::MatrixXd Q;  // of the Krylov space; memory only as far as it has been written
    };

    const Laplacian& laplacian_;
    const ConstantModes& constants_;
    std::vector<Workspace> workspaces_;  // one for each worker
};

}  // namespace spectral
