#pragma once

#include <Eigen/Core>
#include <vector>

#include "components.h"
#include "laplacian.h"
#include "pair_store.h"
#include "parallel_tasks.h"
#include "progress.h"
#include "shifted_ldlt.h"
#include "types.h"

namespace spectral {

/// What a run is to find: the eigenpairs in a slice of the spectrum, from a shift within it.
struct SliceTask {
    double sigma = 0.0;
    double from = 0.0, to = 0.0;  ///< The slice: from <= lambda < to.
    double overlap = 0.0;  ///< How far beyond the slice pairs must have converged: of those within
                           ///< it none is then likely to be overlooked. Of no meaning when the
                           ///< number of missing pairs is given.
    Index firstKnown = 0, known = 0;  ///< Pairs of the store that are not to be found again, of the
                                      ///< slice or near it.
    Index missing = 0;    ///< Pairs that the slice holds beside the known ones: the run ends when
                          ///< it has so many. 0 when that is not known.
    unsigned seed = 0;    ///< Of the start vectors; another for each run.
    Index dimension = 0;  ///< At which the run ends in any case; 0 leaves it to the run.
    double residual = 1e-10;        ///< Of the pairs, |D^-1/2 (W phi - lambda D phi)| / lambda.
    double residualBeyond = 1e-10;  ///< The same, of those that have to converge beyond the slice.
    Index firstCheck = 60;  ///< Krylov dimension at which the run first looks for converged pairs,
                            ///< where their number is not known.
};

/// What a run has found. Its pairs are in the store.
struct SliceRun {
    double sigma = 0.0;
    Index below = 0;  ///< Eigenvalues below sigma, by inertia.
    int solves = 0;

    // Converged pairs cover the part of the slice between these; it is the whole slice unless the
    // space became too large.
    double coveredFrom = 0.0, coveredTo = 0.0;
};

/// Does runs on all cores.
class SliceWorkers {
  public:
    /// The Laplacian and the modes are kept by reference.
    /// @param factors  one for each worker, made where there are none; kept by reference, too.
    ///                 Those of earlier workers need no symbolic analysis where W has the same
    ///                 pattern.
    SliceWorkers(const Laplacian& laplacian, const ConstantModes& constants,
                 std::vector<ShiftedLdlt>& factors);

    /// Does one task as a worker of the caller's own parallel work (see runInParallel).
    /// @throws SolverFailure, and whatever the stop point throws.
    SliceRun run(const SliceTask& task, int worker, PairStore& found, const StopPoint& stopPoint);

    /// Gives the memory of runs back, which runs would use again.
    void releaseMemory() {
        for (Eigen::MatrixXd& Q : spaces_) Q.resize(0, 0);
    }

    /// A worker's own factorization, for other uses of it between its runs.
    ShiftedLdlt& factor(int worker) { return factors_[static_cast<std::size_t>(worker)]; }

    /// Numbers of eigenvalues below these shifts, by inertia.
    std::vector<Index> count(const std::vector<double>& sigmas, const Progress& progress);

    /// Does the tasks; the results are in their order and do not depend on the number of cores.
    /// @throws SolverFailure  of any run; Cancelled.
    std::vector<SliceRun> execute(const std::vector<SliceTask>& tasks, PairStore& found,
                                  const Progress& progress);

  private:
    const Laplacian& laplacian_;
    const ConstantModes& constants_;
    // One for each worker, which uses them again from run to run.
    std::vector<ShiftedLdlt>& factors_;
    std::vector<Eigen::MatrixXd> spaces_;  // memory only as far as it has been written
};

}  // namespace spectral
