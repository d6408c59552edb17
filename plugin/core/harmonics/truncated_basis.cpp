#include "core/harmonics/truncated_basis.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <iomanip>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "core/harmonics/interval_pairs.h"
#include "core/harmonics/spectrum_slicing.h"
#include "core/mesh/mesh.h"
#include "core/support/errors.h"
#include "core/support/memory.h"
#include "core/support/threads.h"

namespace spectral {

namespace {

/// Eigenvalues per interval; the next width is tried if an eigenvalue lies on a cut. Few are best:
/// a factorization costs less than orthogonalizing a large Krylov space (bench_basis).
constexpr Index kWidths[] = {12, 17, 23, 31};

/// Neighbouring eigenvalues closer than this fraction of the mean spacing lambda_k / k (Weyl's law)
/// form a cluster: equal by symmetry, and split only by the triangulation or round-off.
constexpr double kClusterSpacing = 0.1;

/// Relative residual above which a vector is not a harmonic.
constexpr double kUselessResidual = 1e-2;

/// More harmonics than this up to an edge take minutes: almost certainly unintended.
constexpr Index kMaxUpToEdge = 1000;

/// Error of dense eigenvalues, relative to the largest.
constexpr double kDenseError = 1e-15;
/// Tolerable error, relative to the eigenvalue at an edge, in deciding which are below the edge.
constexpr double kEdgeAccuracy = 1e-6;

/// Memory of the factorization, bytes per row, which ShiftedLdlt asks for, too, but later.
constexpr double kFactorBytesPerRow = 1000.0;

constexpr const char* kStage = "computing the harmonics";

/// Orthogonalizes every second interval against its neighbours: eigenvectors of close eigenvalues
/// from different Lanczos runs overlap by their residuals divided by the distance.
/// @return false if two intervals have found the same vector.
bool separate(const std::vector<SpectralInterval>& intervals, const Eigen::VectorXd& D,
              Eigen::MatrixXd& Phi, const Progress& progress) {
    const auto columns = [&](std::size_t i) {
        return Phi.middleCols(intervals[i].first, intervals[i].count);
    };
    std::atomic<bool> differ{true};
    runTasks(
        static_cast<Index>(intervals.size() / 2),
        [&](Index task, int, const StopPoint&) {
            const auto i = static_cast<std::size_t>(2 * task + 1);
            for (const std::size_t j : {i - 1, i + 1})
                if (j < intervals.size() && orthonormalize(D, columns(j), columns(i)) < kOwnPart)
                    differ = false;
        },
        progress, kStage);
    return differ;
}

/// At least the k lowest pairs, in intervals of about `width`; empty if an eigenvalue lies on a cut
/// between two intervals.
std::optional<HarmonicBasis> inIntervals(const Laplacian& laplacian, Index k, Index width,
                                         std::vector<ShiftedLdlt>& factors,
                                         const Progress& progress) {
    const std::vector<SpectralInterval> intervals =
        sliceSpectrum(laplacian, k, width, factors, progress.part(0.0, 0.2));
    HarmonicBasis basis;
    const Index size = intervals.back().first + intervals.back().count;
    basis.Phi.resize(laplacian.D.size(), size);
    basis.Phi.leftCols(laplacian.constants.count()) = laplacian.constants.orthonormal();
    basis.lambda = Eigen::VectorXd::Zero(size);
    std::atomic<bool> isComplete{true};
    runTasks(
        static_cast<Index>(intervals.size()),
        [&](Index task, int thread, const StopPoint& stopPoint) {
            const SpectralInterval& interval = intervals[static_cast<std::size_t>(task)];
            if (!isComplete) return;
            const IntervalPairs pairs = computeInterval(
                laplacian, interval, factors[static_cast<std::size_t>(thread)], stopPoint);
            if (!pairs.isComplete()) {
                isComplete = false;
                return;
            }
            basis.Phi.middleCols(interval.first, interval.count) = pairs.Phi;
            basis.lambda.segment(interval.first, interval.count) = pairs.lambda;
        },
        progress.part(0.2, 0.95), kStage);
    if (!isComplete || !separate(intervals, laplacian.D, basis.Phi, progress.part(0.95, 1.0)))
        return {};
    return basis;
}

/// At least the k lowest pairs.
HarmonicBasis lowestPairs(const Laplacian& laplacian, Index k, ShiftedLdlt& ldlt,
                          const Progress& progress) {
    std::vector<ShiftedLdlt> factors(static_cast<std::size_t>(ThreadTeam::size()),
                                     ldlt.sibling(laplacian.W));
    double done = 0.0;
    for (const Index width : kWidths) {
        const double end = 0.9 + 0.1 * done;
        std::optional<HarmonicBasis> basis =
            inIntervals(laplacian, k, width, factors, progress.part(done, end));
        done = end;
        if (!basis) continue;
        for (const ShiftedLdlt& factor : factors) ldlt.addWork(factor);
        return *std::move(basis);
    }
    throw SolverFailure(ErrorCode::BasisIncomplete,
                        "the solver found fewer harmonics than the inertia of W - sigma D counts");
}

/// @throws SolverFailure  when a harmonic is useless.
void requireUseful(const Eigen::VectorXd& residuals) {
    Index worst = 0;
    const double largest = residuals.maxCoeff<Eigen::PropagateNaN>(&worst);
    if (largest <= kUselessResidual) return;
    std::ostringstream text;
    text << "harmonic " << worst << " is lost in round-off (relative residual "
         << std::setprecision(2) << largest
         << "): the mesh has needle triangles, or parts that are far apart";
    throw SolverFailure(ErrorCode::SingularMatrix, text.str());
}

/// The first `size` pairs of a basis, certified.
HarmonicBasis certified(const Laplacian& laplacian, HarmonicBasis basis, Index size,
                        ShiftedLdlt& ldlt, const Progress& progress) {
    basis.inertiaCount = size;  // if the basis is complete
    if (size < basis.size())
        basis.inertiaCount = countEigenvaluesBelow(
            laplacian.W, laplacian.D, 0.5 * (basis.lambda[size - 1] + basis.lambda[size]), ldlt);
    // Sylvester's law of inertia: none is missing below the cut.
    if (basis.inertiaCount != size)
        throw SolverFailure(ErrorCode::BasisIncomplete,
                            "the solver found " + std::to_string(size) +
                                " harmonics, but the inertia of W - sigma D counts " +
                                std::to_string(basis.inertiaCount));
    basis.Phi.conservativeResize(Eigen::NoChange, size);
    basis.lambda.conservativeResize(size);
    basis.residuals = relativeResiduals(laplacian, basis, progress);
    requireUseful(basis.residuals);
    progress.report(1.0, kStage);
    return basis;
}

/// Rejects a basis that does not fit in memory, before it is allocated.
void requireMemory(Index k, Index n) {
    // Phi, its copies for the certificate, and the vectors of the intervals being computed.
    const double bytesPerHarmonic = 1.3 * sizeof(double) * static_cast<double>(n);
    const double factor = isDenseQuicker(n) ? 0.0 : kFactorBytesPerRow * static_cast<double>(n);
    const double needed = factor + bytesPerHarmonic * static_cast<double>(k);
    const double available = availableMemory();
    if (needed <= available) return;
    const auto fitting =
        static_cast<Index>(std::max(0.0, 0.9 * available - factor) / bytesPerHarmonic);
    if (fitting < 2) spectral::requireMemory(needed, n);
    std::ostringstream text;
    text << k << " harmonics of " << n << " vertices need about " << Bytes{needed} << " of memory, "
         << Bytes{available} << " are free";
    throw Error(ErrorCode::BasisOutOfMemory, text.str(), fitting);
}

void checkSize(Index k, Index n, Index constants) {
    const std::string size = "basis_size = " + std::to_string(k);
    if (k >= n)
        throw InvalidOption(ErrorCode::BasisTooLarge,
                            size + " needs more than " + std::to_string(k) +
                                " vertices; the surface has " + std::to_string(n) +
                                " that are not on a fixed boundary",
                            n - 1);
    if (k <= constants)
        throw InvalidOption(ErrorCode::BasisTooSmall,
                            size + " leaves no room beyond the " + std::to_string(constants) +
                                " constant modes, one for each connected component without a "
                                "fixed boundary",
                            constants + 1);
}

}  // namespace

Eigen::VectorXd relativeResiduals(const Laplacian& laplacian, const HarmonicBasis& basis,
                                  const Progress& progress) {
    const SparseMatrix& W = laplacian.W;
    const Eigen::VectorXd& D = laplacian.D;
    const Index constants = laplacian.constants.count();
    Eigen::VectorXd residuals = Eigen::VectorXd::Zero(basis.size());
    runTasks(
        basis.size() - constants,
        [&](Index task, int, const StopPoint&) {
            const Index i = constants + task;
            const Eigen::VectorXd r =
                W * basis.Phi.col(i) - basis.lambda[i] * D.cwiseProduct(basis.Phi.col(i));
            residuals[i] = r.cwiseQuotient(D.cwiseSqrt()).norm() / std::abs(basis.lambda[i]);
        },
        progress, "checking the harmonics");
    return residuals;
}

std::optional<Index> cutOutsideClusters(const Eigen::VectorXd& lambda, Index asked) {
    const double spacing = lambda[asked - 1] / static_cast<double>(asked);
    for (Index k = asked; k < lambda.size(); ++k)
        if (lambda[k] - lambda[k - 1] > kClusterSpacing * spacing) return k;
    return std::nullopt;
}

HarmonicBasis truncatedBasis(const Laplacian& laplacian, Index k, ShiftedLdlt& ldlt,
                             const Progress& progress) {
    const Index n = laplacian.D.size();
    checkSize(k, n, laplacian.constants.count());
    requireMemory(k, n);
    const ThreadTeam team(progress);
    if (isDenseQuicker(n)) {
        HarmonicBasis all = denseBasis(laplacian);
        const Index size = cutOutsideClusters(all.lambda, k).value_or(n);
        return certified(laplacian, std::move(all), size, ldlt, progress);
    }
    // A few pairs beyond k show whether k cuts a cluster; take more as long as it does.
    for (Index more = 8;; more *= 2) {
        const Index total = std::min(k + more, n - 1);
        HarmonicBasis basis = lowestPairs(laplacian, total, ldlt, progress.part(0.0, 0.95));
        std::optional<Index> size = cutOutsideClusters(basis.lambda, k);
        if (!size) {
            if (total < n - 1) continue;
            size = basis.size();  // nothing left to cut off
        }
        return certified(laplacian, std::move(basis), *size, ldlt, progress.part(0.95, 1.0));
    }
}

HarmonicBasis harmonicsUpTo(double edge, const Laplacian& laplacian, ShiftedLdlt& ldlt,
                            const Progress& progress) {
    const Index n = laplacian.D.size();
    if (isDenseQuicker(n)) {
        HarmonicBasis all = denseBasis(laplacian);
        if (all.lambda[n - 1] * kDenseError > kEdgeAccuracy * edge * edge)
            throw SolverFailure(ErrorCode::SingularMatrix,
                                "the harmonics at the edge of the filter are lost in round-off: "
                                "the mesh has needle triangles");
        return all;
    }
    const Index below = countEigenvaluesBelow(laplacian.W, laplacian.D, edge * edge, ldlt);
    if (below > kMaxUpToEdge)
        throw InvalidOption(ErrorCode::TooManyHarmonics,
                            "response = ideal needs every harmonic up to its edge, here " +
                                std::to_string(below) + " (at most " +
                                std::to_string(kMaxUpToEdge) + ")",
                            kMaxUpToEdge);
    if (below == n) return denseBasis(laplacian);  // nothing to cut
    return truncatedBasis(laplacian, std::max<Index>(below, laplacian.constants.count() + 1), ldlt,
                          progress);
}

}  // namespace spectral
