#include "spectrum_slicing.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "errors.h"
#include "mass_products.h"
#include "slice_runs.h"

namespace spectral {

namespace {

/// Eigenvalues from one of the first shifts to the next. Fewer cost more factorizations, more a
/// Krylov space whose orthogonalization costs the square of its dimension.
constexpr Index kSpacing = 50;

/// Krylov dimension of the first runs: it yields the pairs of about two fifths of the spacing.
constexpr Index kFirstDimension = 72;

/// Relative distance of eigenvalues up to which vectors of different runs are made orthogonal to
/// each other: their overlap is that of their residuals divided by this distance.
constexpr double kNear = 3e-3;

/// The last shift aims at so many pairs more than asked; once it has enough, so many tries are for
/// at most twice as many. Tries in all, after which something must be wrong.
constexpr Index kMorePairs = 4;
constexpr int kTriesForFew = 6, kMaxTries = 60;

/// Factor by which a try goes farther at least, and where the last one has found no eigenvalue: a
/// large part of few vertices has all of its own far below those of small parts.
constexpr double kFarther = 1.02, kAcrossGap = 4.0;

/// Waves of runs after which something must be wrong.
constexpr int kMaxWaves = 40;

/// Eigenvalues below a shift, by inertia, and the part of the spectrum around it whose pairs have
/// been found: nothing, where there was no run.
struct Count {
    double sigma = 0.0;
    Index below = 0;
    double coveredFrom = 0.0, coveredTo = 0.0;
};

Count counted(double sigma, Index below) { return {sigma, below, sigma, sigma}; }

bool operator<(const Count& a, const Count& b) { return a.sigma < b.sigma; }

/// Makes vectors of near eigenvalues D-orthogonal where they come from different runs. That changes
/// their residuals by no more than these are. All others are so already, to the accuracy of the
/// pairs.
/// @param found  sorted.
void orthogonalizeRuns(const Eigen::VectorXd& D, Index constants, PairStore& found) {
    for (Index j = constants + 1; j < found.size(); ++j) {
        auto phi = found.vectors(j, 1);
        const double near = found.lambda(j) * (1.0 - kNear);
        for (Index i = j - 1; i >= constants && found.lambda(i) >= near; --i) {
            if (found.run(i) == found.run(j)) continue;
            const auto other = found.vectors(i, 1);
            subtractProduct(other, innerProducts(other, D, phi), phi);
            phi /= std::sqrt(innerProducts(phi, D, phi)(0, 0));
        }
    }
}

/// Slices the spectrum: lays out the runs, and those that are still needed afterwards.
class Slicing {
  public:
    Slicing(const Laplacian& laplacian, const ConstantModes& constants, Index k,
            std::vector<ShiftedLdlt>& factors)
        : laplacian_(laplacian),
          constants_(constants),
          k_(k),
          workers_(laplacian, constants, factors) {}

    LowestPairs compute(const Progress& progress) {
        calibrate(progress.part(0.0, 0.05));
        const Index c = constants_.count();
        PairStore found(n(), counts_.back().below);
        found.claim(Eigen::VectorXd::Zero(c), 0);
        found.vectors(0, c) = constants_.orthonormal();
        std::vector<SliceTask> tasks = firstTasks();
        double done = 0.05;
        for (int wave = 0; wave < kMaxWaves; ++wave) {
            const double end = done + 0.6 * (1.0 - done);
            for (const SliceRun& run : workers_.execute(tasks, found, progress.part(done, end))) {
                counts_.push_back({run.sigma, run.below, run.coveredFrom, run.coveredTo});
                ++factorizations_;
                solves_ += run.solves;
            }
            done = end;
            std::sort(counts_.begin(), counts_.end());
            found.sort();
            tasks = tasksForMissing(found);
            if (tasks.empty()) {
                orthogonalizeRuns(laplacian_.D, c, found);
                return assembled(found);
            }
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
        counts_.push_back(counted(0.0, constants_.count()));
        countAt({0.25 * top, top}, progress);
        int triesForFew = 0;
        for (int i = 0; i < kMaxTries; ++i) {
            const Count last = counts_.back();
            const bool enough = last.below >= k_;
            if (enough && (last.below <= k_ + 2 * kMorePairs || triesForFew++ == kTriesForFew))
                return;
            const bool inGap = last.below == counts_[counts_.size() - 2].below;
            const double sigma = lambdaAt(static_cast<double>(k_ + kMorePairs));
            const double farther = (inGap ? kAcrossGap : kFarther) * last.sigma;
            countAt({enough ? sigma : std::max(sigma, farther)}, progress);
            // Beyond the first count that suffices none is needed.
            while (counts_[counts_.size() - 2].below >= k_) counts_.pop_back();
        }
        throw SolverFailure("no shift beyond harmonic " + std::to_string(k_) + " could be found");
    }

    void countAt(const std::vector<double>& sigmas, const Progress& progress) {
        const std::vector<Index> below = workers_.count(sigmas, progress);
        for (std::size_t i = 0; i < sigmas.size(); ++i)
            counts_.push_back(counted(sigmas[i], below[i]));
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

    /// Runs around shifts in equal distances. What they do not reach is found between them.
    std::vector<SliceTask> firstTasks() {
        const Index c = constants_.count(), total = counts_.back().below - c;
        const Index runs = std::max<Index>(1, (total + kSpacing / 2) / kSpacing);
        const double spacing = static_cast<double>(total) / static_cast<double>(runs);
        const auto at = [&](double place) {
            return lambdaAt(static_cast<double>(c) + spacing * place);
        };
        std::vector<SliceTask> tasks;
        for (Index i = 0; i < runs; ++i) {
            const double place = static_cast<double>(i);
            SliceTask task;
            task.sigma = at(place + 0.5);
            task.from = i > 0 ? at(place) : 0.0;
            task.to = i + 1 < runs ? at(place + 1.0) : counts_.back().sigma;
            task.seed = seed_++;
            task.dimension = kFirstDimension;
            tasks.push_back(task);
        }
        // These counts have served their purpose: the runs' own ones divide the spectrum.
        counts_.erase(counts_.begin() + 1, counts_.end() - 1);
        return tasks;
    }

    /// A run wherever the counts say that pairs are missing: in what the runs on both sides have
    /// not reached, or copies of multiple eigenvalues in what they have. The pairs that are known
    /// on both sides are no longer in the way: the missing ones are then far nearer to the shift
    /// than all others, and the Lanczos process finds them quickly.
    /// @param found  sorted.
    std::vector<SliceTask> tasksForMissing(const PairStore& found) {
        const Eigen::VectorXd lambda = found.lambdas();
        const auto firstFrom = [&](double bound) {
            return std::max<Index>(
                constants_.count(),
                std::lower_bound(lambda.data(), lambda.data() + lambda.size(), bound) -
                    lambda.data());
        };
        std::vector<std::pair<Index, std::size_t>> gaps;  // missing pairs, and the count above them
        for (std::size_t i = 1; i < counts_.size(); ++i) {
            const Index between = firstFrom(counts_[i].sigma) - firstFrom(counts_[i - 1].sigma);
            const Index missing = counts_[i].below - counts_[i - 1].below - between;
            if (missing < 0)
                throw SolverFailure(
                    "the harmonics could not be told apart: more of them were found than the "
                    "inertia of W - sigma D counts");
            if (missing > 0) gaps.emplace_back(missing, i);
        }
        // The longest runs first: the cores then end at about the same time.
        std::sort(gaps.rbegin(), gaps.rend());
        std::vector<SliceTask> tasks;
        for (const auto& [missing, i] : gaps) {
            const Count& a = counts_[i - 1];
            const Count& b = counts_[i];
            SliceTask task;
            task.sigma = a.coveredTo < b.coveredFrom ? 0.5 * (a.coveredTo + b.coveredFrom)
                                                     : 0.5 * (a.sigma + b.sigma);
            task.from = a.sigma;
            task.to = b.sigma;
            task.firstKnown = firstFrom(a.coveredFrom);
            task.known = firstFrom(b.coveredTo) - task.firstKnown;
            task.missing = missing;
            task.seed = seed_++;
            tasks.push_back(task);
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
    std::vector<Count> counts_;  // ascending
    unsigned seed_ = 1;
    int factorizations_ = 0, solves_ = 0;
};

}  // namespace

LowestPairs lowestPairs(const Laplacian& laplacian, const ConstantModes& constants, Index k,
                        std::vector<ShiftedLdlt>& factors, const Progress& progress) {
    return Slicing(laplacian, constants, k, factors).compute(progress);
}

}  // namespace spectral
