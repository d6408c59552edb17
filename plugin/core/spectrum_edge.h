#pragma once

#include <Eigen/Core>

#include "components.h"
#include "laplacian.h"
#include "pair_store.h"
#include "parallel_tasks.h"
#include "progress.h"
#include "slice_runs.h"
#include "types.h"

namespace spectral {

/// The eigenpairs next to the cut of a basis, on both sides, for an update: computed anew, without
/// gaps, and nearly as exactly as those of a basis from nothing.
///
/// A Lanczos run finds them. The inertia at the end of its part of the spectrum tells whether it
/// has overlooked copies of multiple eigenvalues there; the run itself cannot.
///
/// In the order of use: run and countAtEnd, which may be at the same time; complete; the rest.
class SpectrumEdge {
  public:
    /// @param k         harmonics wanted.
    /// @param quotient  of the previous harmonics but the constant modes, ascending: about where
    ///                  the eigenvalues are now.
    /// The Laplacian and the workers, which are for it, are kept by reference.
    SpectrumEdge(const Laplacian& laplacian, const ConstantModes& constants, Index k,
                 const Eigen::VectorXd& quotient, SliceWorkers& workers);

    /// Runs as one worker of the caller's own parallel work (see runInParallel).
    /// @throws SolverFailure, and whatever the stop point throws.
    void run(int worker, const StopPoint& stopPoint);

    /// Counts the eigenvalues below the end, by inertia.
    void countAtEnd(int worker);

    /// Finds what the run has overlooked above its shift, on all cores. Copies that it has
    /// overlooked below are among what the caller finds there.
    /// @throws SolverFailure  when pairs stay missing; Cancelled.
    void complete(const Progress& progress);

    /// No pair is at or above this; what follows may be anywhere from here on.
    double end() const { return task_.to; }

    /// Ascending.
    PairStore& pairs() { return pairs_; }

    /// Shift of the run, and the number of eigenvalues below it, by inertia.
    double shift() const { return run_.sigma; }
    Index eigenvaluesBelowShift() const { return run_.below; }

    /// Number of all eigenvalues that are not of the edge's pairs but below some of them: all below
    /// the shift, but for the pairs there.
    Index eigenvaluesBefore() const;

    int factorizations() const { return factorizations_; }
    int solves() const { return solves_; }

  private:
    Index missing() const;
    void runAlone(const SliceTask& task, const Progress& progress);

    const Laplacian& laplacian_;
    SliceWorkers& workers_;
    SliceTask task_;
    PairStore pairs_;
    SliceRun run_;
    Index belowEnd_ = 0;  // eigenvalues below the end
    int factorizations_ = 0, solves_ = 0;
};

}  // namespace spectral
