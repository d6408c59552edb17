#include "spectrum_slicing.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "errors.h"
#include "slice_runs.h"

namespace spectral {

namespace {

/// Eigenvalues of a slice. Fewer cost more factorizations, more a Krylov space whose
/// orthogonalization costs the square of its dimension.
constexpr Index kSpacing = 20;

/// Mean spacings by which a run goes beyond its slice.
constexpr double kOverlap = 1.0;

/// Relative distance of eigenvalues up to which vectors are made orthogonal to each other: if they
/// come from different runs, their overlap is that of their residuals divided by this distance.
constexpr double kNear = 3e-3;

/// The last shift aims at so many pairs more than asked; tries for at most twice as many, and for
/// any number. Every other try goes farther by this factor at least.
constexpr Index kMorePairs = 4;
constexpr int kTriesForFew = 3, kMaxTries = 40;
constexpr double kFarther = 1.02;

/// Waves of runs after which something must be wrong.
constexpr int kMaxWaves = 12;

/// Waves of runs for gaps, one after another, after which something must be wrong.
constexpr int kMaxGapWaves = 12;

/// Eigenvalues below a shift, by inertia.
struct Count {
    double sigma = 0.0;
    Index below = 0;
};

bool operator<(const Count& a, const Count& b) { return a.sigma < b.sigma; }

/// Makes columns of near eigenvalues D-orthonormal: they may come from different runs. That changes
/// their residuals by no more than these are. All others are so already, to the accuracy of the
/// pairs.
void orthonormalizeNear(const Eigen::VectorXd& D, const Eigen::VectorXd& lambda,
                        Eigen::Ref<Eigen::MatrixXd> Phi) {
    for (Index j = 1; j < lambda.size(); ++j) {
        for (Index i = j - 1; i >= 0 && lambda[j] - lambda[i] <= kNear * lambda[j]; --i)
            Phi.col(j) -= Phi.col(i).dot(D.cwiseProduct(Phi.col(j))) * Phi.col(i);
        Phi.col(j) /= std::sqrt(Phi.col(j).dot(D.cwiseProduct(Phi.col(j))));
    }
}

/// Slices the spectrum: lays out the runs, and those that are still needed afterwards.
class Slicing {
  public:
    Slicing(const Laplacian& laplacian, const ConstantModes& constants, Index k)
        : laplacian_(laplacian), constants_(constants), k_(k), workers_(laplacian, constants) {}

    LowestPairs compute(const Progress& progress) {
        calibrate(progress.part(0.0, 0.05));
        const Index c = constants_.count();
        PairStore found(n(), counts_.back().below);
        found.claim(Eigen::VectorXd::Zero(c), 0);
        found.vectors(0, c) = constants_.orthonormal();
        std::vector<SliceTask> tasks = firstTasks();
        double done = 0.05;
        Index searched = -1;  // size when copies were last seen to be missing
        for (int gapWaves = 0; gapWaves < kMaxGapWaves;) {
            const double end = done + 0.8 * (1.0 - done);
            const std::vector<SliceRun> runs =
                workers_.execute(tasks, found, progress.part(done, end));
            done = end;
            for (const SliceRun& run : runs) {
                counts_.push_back({run.sigma, run.below});
                ++factorizations_;
                solves_ += run.solves;
            }
            std::sort(counts_.begin(), counts_.end());
            tasks = tasksForGaps(tasks, runs);
            if (!tasks.empty()) {
                ++gapWaves;
                continue;
            }
            found.sort();
            const Index rest = found.size() - c;
            orthonormalizeNear(laplacian_.D, found.lambdas().tail(rest), found.vectors(c, rest));
            tasks = tasksForMissingCopies(found);
            if (tasks.empty()) return assembled(found);
            if (found.size() == searched) break;
            searched = found.size();
            gapWaves = 0;
        }
        throw SolverFailure(
            "the harmonics could not all be found: the inertia of W - sigma D counts more of them; "
            "choose a smaller basis_size");
    }

  private:
    Index n() const { return laplacian_.D.size(); }
    double weylSlope() const { return 4.0 * kPi / laplacian_.D.sum(); }

    /// Counts at some frequencies correct Weyl's law lambda_N ~ 4 pi N / area. The last one is the
    /// end of the spectrum that is computed: it has at least k eigenvalues below it.
    void calibrate(const Progress& progress) {
        const double top = weylSlope() * static_cast<double>(k_);
        counts_.push_back({0.0, static_cast<Index>(constants_.count())});
        countAt({0.25 * top, top}, progress);
        for (int i = 0; i < kMaxTries; ++i) {
            const bool enough = counts_.back().below >= k_;
            if (enough && (i >= kTriesForFew || counts_.back().below <= k_ + 2 * kMorePairs))
                return;
            const double sigma = lambdaAt(static_cast<double>(k_ + kMorePairs));
            countAt({enough ? sigma : std::max(sigma, kFarther * counts_.back().sigma)}, progress);
            // Beyond the first count that suffices none is needed.
            while (counts_[counts_.size() - 2].below >= k_) counts_.pop_back();
        }
        throw SolverFailure("no shift beyond harmonic " + std::to_string(k_) + " could be found");
    }

    void countAt(const std::vector<double>& sigmas, const Progress& progress) {
        const std::vector<Index> below = workers_.count(sigmas, progress);
        for (std::size_t i = 0; i < sigmas.size(); ++i) counts_.push_back({sigmas[i], below[i]});
        factorizations_ += static_cast<int>(sigmas.size());
        std::sort(counts_.begin(), counts_.end());
    }

    /// About the eigenvalue of this index, between the counts that are known.
    double lambdaAt(double index) const {
        for (std::size_t i = 1; i < counts_.size(); ++i) {
            const Count& a = counts_[i - 1];
            const Count& b = counts_[i];
            if (b.below > a.below &&
                (index <= static_cast<double>(b.below) || i + 1 == counts_.size()))
                return a.sigma + (b.sigma - a.sigma) * (index - static_cast<double>(a.below)) /
                                     static_cast<double>(b.below - a.below);
        }
        return weylSlope() * index;
    }

    SliceTask task(double from, double to, double overlap,
                   const Eigen::Ref<const Eigen::MatrixXd>& known, Index missing) {
        return {0.5 * (from + to), from, to, overlap, known, missing, seed_++};
    }

    std::vector<SliceTask> firstTasks() {
        const Index c = constants_.count(), total = counts_.back().below - c;
        const Index slices = std::max<Index>(1, (total + kSpacing / 2) / kSpacing);
        const double spacing = static_cast<double>(total) / static_cast<double>(slices);
        std::vector<SliceTask> tasks;
        double from = 0.0;
        for (Index i = 1; i <= slices; ++i) {
            const double to =
                i < slices ? lambdaAt(static_cast<double>(c) + spacing * static_cast<double>(i))
                           : counts_.back().sigma;
            tasks.push_back(task(from, to, kOverlap / spacing * (to - from), none_, 0));
            from = to;
        }
        return tasks;
    }

    /// Whether the counts say that there is no eigenvalue between these.
    bool isEmpty(double from, double to) const {
        const auto above = std::lower_bound(counts_.begin(), counts_.end(), Count{to, 0});
        const auto beyond = std::upper_bound(counts_.begin(), counts_.end(), Count{from, 0});
        return above != counts_.end() && beyond != counts_.begin() &&
               std::prev(beyond)->below == above->below;
    }

    /// A run for every part of a slice that its run has not covered.
    std::vector<SliceTask> tasksForGaps(const std::vector<SliceTask>& tasks,
                                        const std::vector<SliceRun>& runs) {
        std::vector<SliceTask> more;
        const auto cover = [&](const SliceTask& slice, double from, double to) {
            if (from < to && !isEmpty(from, to))
                more.push_back(task(from, to, 0.0, slice.known, 0));
        };
        for (std::size_t i = 0; i < runs.size(); ++i) {
            cover(tasks[i], tasks[i].from, runs[i].coveredFrom);
            cover(tasks[i], runs[i].coveredTo, tasks[i].to);
        }
        return more;
    }

    /// A Lanczos run from one vector sees one copy of a multiple eigenvalue, others only by
    /// round-off: those that the counts say are missing are sought beside the known ones.
    /// @param found  sorted.
    std::vector<SliceTask> tasksForMissingCopies(PairStore& found) {
        std::vector<SliceTask> tasks;
        Index first = constants_.count();
        for (std::size_t i = 1; i < counts_.size(); ++i) {
            Index end = first;
            while (end < found.size() && found.lambda(end) < counts_[i].sigma) ++end;
            const Index missing = counts_[i].below - counts_[i - 1].below - (end - first);
            if (missing < 0)
                throw SolverFailure(
                    "the harmonics could not be told apart: more of them were found than the "
                    "inertia of W - sigma D counts");
            if (missing > 0)
                tasks.push_back(task(counts_[i - 1].sigma, counts_[i].sigma, 0.0,
                                     found.vectors(first, end - first), missing));
            first = end;
        }
        return tasks;
    }

    LowestPairs assembled(PairStore& found) const {
        LowestPairs result;
        result.lambda = found.lambdas();
        result.Phi = found.release();
        result.factorizations = factorizations_;
        result.solves = solves_;
        return result;
    }

    const Laplacian& laplacian_;
    const ConstantModes& constants_;
    Index k_;
    SliceWorkers workers_;
    Eigen::MatrixXd none_;
    std::vector<Count> counts_;  // ascending
    unsigned seed_ = 1;
    int factorizations_ = 0, solves_ = 0;
};

}  // namespace

LowestPairs lowestPairs(const Laplacian& laplacian, const ConstantModes& constants, Index k,
                        const Progress& progress) {
    return Slicing(laplacian, constants, k).compute(progress);
}

}  // namespace spectral
