#include "core/harmonics/truncated_basis.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "core/harmonics/slice_pairs.h"
#include "core/harmonics/spectrum_slicing.h"
#include "core/laplacian/constant_modes.h"
#include "core/mesh/mesh.h"
#include "core/support/errors.h"
#include "core/support/parallel_tasks.h"

namespace spectral {

namespace {

/// Eigenvalues of a slice. Few are best: our factorization costs less than the orthogonalization
/// of a large Krylov space (bench_basis).
constexpr Index kWidth = 12;

/// Times that slices are merged because an eigenvalue lies where they meet.
constexpr int kMostMerges = 8;

/// Neighbouring eigenvalues nearer than this part of the mean spacing lambda_k / k (Weyl's law)
/// belong to one cluster: equal ones by symmetry, told apart by the mesh or by round-off only.
constexpr double kClusterSpacing = 0.1;

constexpr const char* kStage = "computing the harmonics";

/// The lowest harmonics, slice by slice.
class SlicedBasis {
  public:
    SlicedBasis(const Laplacian& laplacian, const ConstantModes& constants,
                ShiftedCholesky& cholesky)
        : laplacian_(laplacian),
          constants_(constants),
          cholesky_(cholesky),
          factors_(static_cast<std::size_t>(workerCount()), cholesky.emptyFactor(laplacian)) {}

    ~SlicedBasis() {
        for (const ShiftedLdlt& factor : factors_) cholesky_.countWork(factor);
    }

    /// At least k pairs.
    HarmonicBasis compute(Index k, const Progress& progress) {
        slices_ =
            sliceSpectrum(laplacian_, constants_, k, kWidth, factors_, progress.part(0.0, 0.1));
        isComplete_.assign(slices_.size(), 0);
        const Index c = constants_.count();
        const Index size = slices_.back().first + slices_.back().count;
        basis_.Phi.resize(laplacian_.D.size(), size);
        basis_.Phi.leftCols(c) = constants_.orthonormal();
        basis_.lambda = Eigen::VectorXd::Zero(size);
        double done = 0.1;
        for (int merges = 0; merges <= kMostMerges; ++merges) {
            const double end = done + 0.8 * (1.0 - done);
            computeIncomplete(progress.part(done, end));
            separateNeighbours(progress.part(end, end));
            done = end;
            if (!mergeIncomplete()) return std::move(basis_);
        }
        throw SolverFailure(
            "the harmonics could not all be found: the inertia of W - sigma D counts more of them; "
            "choose a smaller basis_size");
    }

  private:
    auto columns(const SpectrumSlice& slice) {
        return basis_.Phi.middleCols(slice.first, slice.count);
    }

    void computeIncomplete(const Progress& progress) {
        std::vector<std::size_t> incomplete;
        for (std::size_t i = 0; i < slices_.size(); ++i)
            if (!isComplete_[i]) incomplete.push_back(i);
        runInParallel(
            static_cast<Index>(incomplete.size()),
            [&](Index task, int worker, const StopPoint& stopPoint) {
                const std::size_t i = incomplete[static_cast<std::size_t>(task)];
                const SpectrumSlice& slice = slices_[i];
                const SlicePairs pairs =
                    computeSlice(laplacian_, constants_, slice,
                                 factors_[static_cast<std::size_t>(worker)], stopPoint);
                if (!pairs.isComplete()) return;
                columns(slice) = pairs.Phi;
                basis_.lambda.segment(slice.first, slice.count) = pairs.lambda;
                isComplete_[i] = 1;
            },
            progress, kStage);
    }

    /// Makes every second slice orthogonal to its neighbours: eigenvectors of near eigenvalues
    /// from different runs overlap by their residuals, divided by the distance.
    void separateNeighbours(const Progress& progress) {
        // Slices that have a vector in common with the next one: an eigenvalue lies on the cut.
        std::vector<char> meetsNext(slices_.size(), 0);
        runInParallel(
            static_cast<Index>(slices_.size() / 2),
            [&](Index task, int, const StopPoint&) {
                const auto i = static_cast<std::size_t>(2 * task + 1);
                if (!isComplete_[i]) return;
                for (const std::size_t j : {i - 1, i + 1}) {
                    if (j >= slices_.size() || !isComplete_[j]) continue;
                    if (orthonormalize(laplacian_.D, columns(slices_[j]), columns(slices_[i])) <
                        kOwnPart)
                        meetsNext[std::min(i, j)] = 1;
                }
            },
            progress, kStage);
        for (std::size_t i = 0; i < slices_.size(); ++i)
            if (meetsNext[i]) isComplete_[i] = 0;  // and is merged with the next one
    }

    /// Merges every slice that is incomplete with the next one, or the last with the one before;
    /// returns whether there was one.
    bool mergeIncomplete() {
        std::vector<SpectrumSlice> slices;
        std::vector<char> isComplete;
        bool any = false, joins = false;
        for (std::size_t i = 0; i < slices_.size(); ++i) {
            const bool isLast = i + 1 == slices_.size();
            any = any || !isComplete_[i];
            if (!slices.empty() && (joins || (!isComplete_[i] && isLast))) {
                slices.back().to = slices_[i].to;
                slices.back().count += slices_[i].count;
                isComplete.back() = 0;
            } else {
                slices.push_back(slices_[i]);
                isComplete.push_back(isComplete_[i]);
            }
            joins = !isComplete_[i];
        }
        slices_ = std::move(slices);
        isComplete_ = std::move(isComplete);
        return any;
    }

    const Laplacian& laplacian_;
    const ConstantModes& constants_;
    ShiftedCholesky& cholesky_;
    std::vector<ShiftedLdlt> factors_;
    std::vector<SpectrumSlice> slices_;
    std::vector<char> isComplete_;  // of the slices; not of bool: threads write to it
    HarmonicBasis basis_;
};

/// |D^-1/2 (W phi - lambda D phi)| / lambda of every harmonic but the constant ones.
Eigen::VectorXd relativeResiduals(const Laplacian& laplacian, Index constants,
                                  const HarmonicBasis& basis, const Progress& progress) {
    const auto& [W, D] = laplacian;
    Eigen::VectorXd residuals = Eigen::VectorXd::Zero(basis.size());
    runInParallel(
        basis.size() - constants,
        [&](Index task, int, const StopPoint&) {
            const Index i = constants + task;
            const Eigen::VectorXd r =
                W * basis.Phi.col(i) - basis.lambda[i] * D.cwiseProduct(basis.Phi.col(i));
            residuals[i] = r.cwiseQuotient(D.cwiseSqrt()).norm() / basis.lambda[i];
        },
        progress, "checking the harmonics");
    if (!residuals.allFinite())
        throw SolverFailure(
            "the harmonics are not finite numbers: the mesh probably has degenerate triangles "
            "('Remove Zero Area Faces')");
    return residuals;
}

/// The first `size` pairs of a basis, with their certificate.
HarmonicBasis certified(const Laplacian& laplacian, const ConstantModes& constants,
                        HarmonicBasis basis, Index size, ShiftedCholesky& cholesky,
                        const Progress& progress) {
    basis.inertiaCount = size;  // where it holds all that there are
    if (size < basis.size())
        basis.inertiaCount = cholesky.countEigenvaluesBelow(
            laplacian, 0.5 * (basis.lambda[size - 1] + basis.lambda[size]));
    // Sylvester's law of inertia: none is missing below the cut.
    if (basis.inertiaCount != size)
        throw SolverFailure("of the " + std::to_string(basis.inertiaCount) +
                            " harmonics that the inertia of W - sigma D counts, " +
                            std::to_string(size) + " were found; choose another basis_size");
    basis.Phi.conservativeResize(Eigen::NoChange, size);
    basis.lambda.conservativeResize(size);
    basis.residuals = relativeResiduals(laplacian, constants.count(), basis, progress);
    progress.report(1.0, kStage);
    return basis;
}

void checkSize(Index k, Index n, Index constants) {
    if (k >= n)
        throw InvalidOption("basis_size = " + std::to_string(k) + " needs more than " +
                            std::to_string(k) + " vertices; the mesh has " + std::to_string(n) +
                            ": choose a smaller basis_size");
    if (k <= constants)
        throw InvalidOption(
            "basis_size = " + std::to_string(k) + " holds no more than the constant modes of the " +
            std::to_string(constants) + " connected components: choose a basis_size above " +
            std::to_string(constants));
}

}  // namespace

std::optional<Index> cutOutsideClusters(const Eigen::VectorXd& lambda, Index asked) {
    const double spacing = lambda[asked - 1] / static_cast<double>(asked);
    for (Index k = asked; k < lambda.size(); ++k)
        if (lambda[k] - lambda[k - 1] > kClusterSpacing * spacing) return k;
    return std::nullopt;
}

HarmonicBasis truncatedBasis(const Laplacian& laplacian, const ConstantModes& constants, Index k,
                             ShiftedCholesky& cholesky, const Progress& progress) {
    const Index n = laplacian.D.size();
    checkSize(k, n, constants.count());
    if (isDenseQuicker(n)) {
        HarmonicBasis all = denseBasis(laplacian, constants);
        const Index size = cutOutsideClusters(all.lambda, k).value_or(n);
        return certified(laplacian, constants, std::move(all), size, cholesky, progress);
    }
    // Some pairs beyond k show whether k cuts a cluster; more are taken while it does.
    for (Index more = 8;; more *= 2) {
        const Index total = std::min(k + more, n - 1);
        HarmonicBasis basis =
            SlicedBasis(laplacian, constants, cholesky).compute(total, progress.part(0.0, 0.95));
        std::optional<Index> size = cutOutsideClusters(basis.lambda, k);
        if (!size) {
            if (total < n - 1) continue;
            size = basis.size();  // nothing left to cut off
        }
        return certified(laplacian, constants, std::move(basis), *size, cholesky,
                         progress.part(0.95, 1.0));
    }
}

}  // namespace spectral
