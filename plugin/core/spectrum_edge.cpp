#include "spectrum_edge.h"

#include "errors.h"

namespace spectral {

namespace {

/// Harmonics next to the cut that are computed, below and above it.
constexpr Index kBelow = 10, kAbove = 8;

/// How far beyond these the pairs of the run have to converge, in mean distances of eigenvalues;
/// their residuals, within the edge and there; and the Krylov dimension at which that is first
/// looked at.
constexpr double kOverlap = 1.0, kResidual = 3e-5, kResidualBeyond = 1e-3;
constexpr Index kFirstCheck = 44;

/// From some pairs below the wanted number to some above the number that the previous basis had,
/// which did not cut a cluster.
SliceTask taskOf(Index k, Index wanted, const Eigen::VectorXd& quotient) {
    const Index first = wanted - kBelow;
    const double spacing = quotient[wanted - 1] / static_cast<double>(k);
    SliceTask task;
    task.from = 0.5 * (quotient[first - 1] + quotient[first]);
    task.to = quotient[quotient.size() - 1] + static_cast<double>(kAbove) * spacing;
    task.sigma = 0.5 * (task.from + task.to);
    task.overlap = kOverlap * spacing;
    task.seed = 1;
    task.residual = kResidual;
    task.residualBeyond = kResidualBeyond;
    task.firstCheck = kFirstCheck;
    return task;
}

}  // namespace

SpectrumEdge::SpectrumEdge(const Laplacian& laplacian, const ConstantModes& constants, Index k,
                           const Eigen::VectorXd& quotient, SliceWorkers& workers)
    : laplacian_(laplacian),
      workers_(workers),
      task_(taskOf(k, k - constants.count(), quotient)),
      // More would mean that the spectrum has changed too much.
      pairs_(laplacian.D.size(), 2 * (quotient.size() + constants.count() - k + kBelow + kAbove)) {}

void SpectrumEdge::run(int worker, const StopPoint& stopPoint) {
    run_ = workers_.run(task_, worker, pairs_, stopPoint);
}

void SpectrumEdge::countAtEnd(int worker) {
    ShiftedLdlt& factor = workers_.factor(worker);
    factor.factorize(laplacian_, end());
    belowEnd_ = factor.eigenvaluesBelow();
}

void SpectrumEdge::complete(const Progress& progress) {
    factorizations_ = 2;
    solves_ = run_.solves;
    if (missing() > 0) {
        // Once more, accurately: another run can then leave out what is known, and find the rest.
        SliceTask again = task_;
        again.residual = again.residualBeyond = SliceTask().residual;
        pairs_.clear();
        runAlone(again, progress.part(0.0, 0.5));
    }
    if (missing() > 0) {
        SliceTask copies;
        copies.from = shift();
        copies.to = end();
        copies.sigma = 0.5 * (copies.from + copies.to);
        copies.known = pairs_.size();
        copies.missing = missing();
        copies.seed = task_.seed + 1;
        runAlone(copies, progress.part(0.5, 1.0));
    }
    if (missing() != 0) throw SolverFailure("the edge has not as many pairs as the inertia counts");
    pairs_.sort();
}

Index SpectrumEdge::eigenvaluesBefore() const {
    return run_.below - (pairs_.lambdas().array() < shift()).count();
}

/// Of the pairs from the shift to the end.
Index SpectrumEdge::missing() const {
    return belowEnd_ - run_.below - (pairs_.lambdas().array() >= shift()).count();
}

void SpectrumEdge::runAlone(const SliceTask& task, const Progress& progress) {
    solves_ += workers_.execute({task}, pairs_, progress).front().solves;
    ++factorizations_;
}

}  // namespace spectral
