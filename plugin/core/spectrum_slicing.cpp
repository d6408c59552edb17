#include "spectrum_slicing.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "errors.h"
#include "slice_runs.h"

namespace spectral {

namespace {

/// Eigenvalues from one shift to the next. Fewer cost more factorizations, more a Krylov space
/// whose orthogonalization costs the square of its dimension.
constexpr Index kSpacing = 26;

/// Pairs that a run finds beyond half the way to the next shift, so that neighbours overlap.
constexpr Index kOverlap = 4;

/// Relative distance of eigenvalues of whose vectors nothing but orthogonality is well defined.
constexpr double kEqual = 1e-6;

/// Waves of runs after which something must be wrong.
constexpr int kMaxWaves = 12;

/// An eigenpair of a run.
struct Pair {
    const SliceRun* run;
    Index column;

    double lambda() const { return run->lambda[column]; }
    auto phi() const { return run->Phi.col(column); }
};

/// The pairs between two neighbouring shifts, and what is wrong with them.
struct Slice {
    double from = 0.0, to = 0.0;
    Index expected = 0;       // by inertia
    std::vector<Pair> pairs;  // ascending
    bool gap = false;         // the runs on both sides do not meet
    double gapFrom = 0.0, gapTo = 0.0;

    Index missing() const { return expected - static_cast<Index>(pairs.size()); }
};

/// Takes the pairs of `run` with from < lambda < to.
void take(const SliceRun& run, double from, double to, std::vector<Pair>& pairs) {
    for (Index i = 0; i < run.lambda.size(); ++i)
        if (run.lambda[i] > from && run.lambda[i] < to) pairs.push_back({&run, i});
}

/// Where pairs of the left run end and those of the right one begin: in the widest gap of the
/// eigenvalues that both have found, so that no group of equal ones is torn apart.
double splitOf(const SliceRun& left, const SliceRun& right) {
    std::vector<double> both;
    for (const double lambda : left.lambda)
        if (lambda >= right.lowest() * (1.0 - kEqual)) both.push_back(lambda);
    for (const double lambda : right.lambda)
        if (lambda > left.highest() * (1.0 + kEqual)) {
            both.push_back(lambda);
            break;
        }
    double split = left.highest() * (1.0 + kEqual), widest = 0.0;
    for (std::size_t i = 1; i < both.size(); ++i)
        if (both[i] - both[i - 1] > widest) {
            widest = both[i] - both[i - 1];
            split = 0.5 * (both[i] + both[i - 1]);
        }
    return split;
}

/// @param left    nullptr below the first shift, where only the constants are.
/// @param extras  runs for missing copies.
Slice sliceBetween(const SliceRun* left, const SliceRun& right, Index constants,
                   const std::deque<SliceRun>& extras) {
    Slice slice;
    slice.from = left != nullptr ? left->sigma : 0.0;
    slice.to = right.sigma;
    slice.expected = right.below - (left != nullptr ? left->below : constants);
    const double reached = left != nullptr ? left->highest() : 0.0;
    if (reached < right.lowest() * (1.0 - kEqual)) {
        slice.gap = true;
        slice.gapFrom = reached;
        slice.gapTo = right.lowest();
        if (left != nullptr) take(*left, slice.from, slice.to, slice.pairs);
        take(right, slice.from, slice.to, slice.pairs);
    } else {
        const double split = std::clamp(splitOf(*left, right), slice.from, slice.to);
        take(*left, slice.from, split, slice.pairs);
        take(right, split, slice.to, slice.pairs);
    }
    for (const SliceRun& extra : extras) take(extra, slice.from, slice.to, slice.pairs);
    std::stable_sort(slice.pairs.begin(), slice.pairs.end(),
                     [](const Pair& a, const Pair& b) { return a.lambda() < b.lambda(); });
    return slice;
}

/// Makes columns of nearly equal eigenvalues D-orthonormal: they may come from different runs. All
/// others are so already, to the accuracy of the pairs.
void orthonormalizeClusters(const Eigen::VectorXd& D, const Eigen::VectorXd& lambda,
                            Eigen::MatrixXd& Phi) {
    for (Index j = 1; j < lambda.size(); ++j) {
        for (Index i = j - 1; i >= 0 && lambda[j] - lambda[i] <= kEqual * lambda[j]; --i)
            Phi.col(j) -= Phi.col(i).dot(D.cwiseProduct(Phi.col(j))) * Phi.col(i);
        Phi.col(j) /= std::sqrt(Phi.col(j).dot(D.cwiseProduct(Phi.col(j))));
    }
}

Eigen::MatrixXd vectorsOf(const std::vector<Pair>& pairs, Index n) {
    Eigen::MatrixXd Phi(n, static_cast<Index>(pairs.size()));
    for (std::size_t i = 0; i < pairs.size(); ++i) Phi.col(static_cast<Index>(i)) = pairs[i].phi();
    return Phi;
}

Eigen::VectorXd valuesOf(const std::vector<Pair>& pairs) {
    Eigen::VectorXd lambda(static_cast<Index>(pairs.size()));
    for (std::size_t i = 0; i < pairs.size(); ++i)
        lambda[static_cast<Index>(i)] = pairs[i].lambda();
    return lambda;
}

/// Slices the spectrum: holds the runs, and plans those that are still needed.
class Slicing {
  public:
    Slicing(const Laplacian& laplacian, const ConstantModes& constants, Index k)
        : laplacian_(laplacian), constants_(constants), k_(k), workers_(laplacian, constants) {}

    LowestPairs compute(const Progress& progress) {
        calibrate(progress.part(0.0, 0.05));
        std::vector<SliceTask> tasks = firstTasks();
        double done = 0.05;
        for (int wave = 0;; ++wave) {
            const double end = done + 0.8 * (1.0 - done);
            for (SliceRun& run : workers_.execute(tasks, progress.part(done, end))) {
                solves_ += run.solves;
                ++factorizations_;
                runs_.push_back(std::move(run));
            }
            done = end;
            std::sort(runs_.begin(), runs_.end(),
                      [](const SliceRun& a, const SliceRun& b) { return a.sigma < b.sigma; });
            tasks = tasksForGaps();
            if (tasks.empty() && !searchMissingCopies(progress.part(done, done)))
                return assembled();
            if (wave == kMaxWaves)
                throw SolverFailure(
                    "the harmonics could not all be found: the inertia of W - sigma D counts more "
                    "of them; choose a smaller basis_size, or spectrum = full");
        }
    }

  private:
    Index n() const { return laplacian_.D.size(); }
    double weylSlope() const { return 4.0 * kPi / laplacian_.D.sum(); }

    /// Counts at two frequencies correct Weyl's law lambda_N ~ 4 pi N / area.
    void calibrate(const Progress& progress) {
        const double top = weylSlope() * static_cast<double>(k_);
        std::vector<SliceTask> tasks(2);
        tasks[0].sigma = 0.25 * top;
        tasks[1].sigma = top;
        counts_.emplace_back(constants_.count(), 0.0);
        for (const SliceRun& run : workers_.execute(tasks, progress)) {
            ++factorizations_;
            counts_.emplace_back(run.below, run.sigma);
        }
    }

    /// About the eigenvalue of this index, between the counts that are known.
    double lambdaAt(double index) const {
        for (std::size_t i = 1; i < counts_.size(); ++i) {
            const auto [n0, l0] = counts_[i - 1];
            const auto [n1, l1] = counts_[i];
            if (n1 > n0 && (index <= static_cast<double>(n1) || i + 1 == counts_.size()))
                return l0 +
                       (l1 - l0) * (index - static_cast<double>(n0)) / static_cast<double>(n1 - n0);
        }
        return weylSlope() * index;
    }

    std::vector<SliceTask> firstTasks() {
        const double span = static_cast<double>(k_ - constants_.count());
        const auto runs = std::max<Index>(1, (k_ - constants_.count() + kSpacing / 2) / kSpacing);
        const double spacing = span / (static_cast<double>(runs) - 0.5);
        const Index half = static_cast<Index>(std::ceil(0.5 * spacing)) + kOverlap;
        std::vector<SliceTask> tasks(static_cast<std::size_t>(runs));
        for (std::size_t i = 0; i < tasks.size(); ++i) {
            const double index = constants_.count() + spacing * (static_cast<double>(i) + 0.5);
            const bool last = i + 1 == tasks.size();
            tasks[i].sigma = lambdaAt(last ? index + 2.0 : index);
            tasks[i].down =
                i == 0 ? static_cast<Index>(index) - constants_.count() + kOverlap : half;
            tasks[i].up = last ? 0 : half;
            tasks[i].seed = seed_++;
        }
        return tasks;
    }

    std::vector<Slice> slices() const {
        std::vector<Slice> all;
        for (std::size_t i = 0; i < runs_.size(); ++i)
            all.push_back(sliceBetween(i > 0 ? &runs_[i - 1] : nullptr, runs_[i],
                                       constants_.count(), extras_));
        return all;
    }

    /// A run in every gap between two runs, and one beyond the last while it has too few below it.
    std::vector<SliceTask> tasksForGaps() {
        std::vector<SliceTask> tasks;
        for (const Slice& slice : slices()) {
            if (!slice.gap || slice.missing() <= 0) continue;
            SliceTask task;
            task.sigma = 0.5 * (slice.gapFrom + slice.gapTo);
            task.down = task.up = std::min(kSpacing, slice.missing()) / 2 + kOverlap;
            task.seed = seed_++;
            tasks.push_back(task);
        }
        const Index below = runs_.back().below;
        if (below < k_) {
            SliceTask task;
            const Index more = std::min(k_ - below, kSpacing) + 2;
            task.sigma = runs_.back().sigma + static_cast<double>(more) * runs_.back().sigma /
                                                  static_cast<double>(std::max<Index>(1, below));
            task.down = more + kOverlap;
            task.seed = seed_++;
            tasks.push_back(task);
        }
        return tasks;
    }

    /// A Lanczos run from one vector sees one copy of a multiple eigenvalue, others only by
    /// round-off: those that the count says are missing are sought beside the known ones.
    /// @return whether there were any.
    bool searchMissingCopies(const Progress& progress) {
        std::vector<SliceTask> tasks;
        std::vector<Slice> searched;
        std::deque<Eigen::MatrixXd> known;
        for (Slice& slice : slices()) {
            if (slice.missing() <= 0) continue;
            Eigen::MatrixXd vectors = vectorsOf(slice.pairs, n());
            orthonormalizeClusters(laplacian_.D, valuesOf(slice.pairs), vectors);
            known.push_back(std::move(vectors));
            SliceTask task;
            task.sigma = 0.5 * (slice.from + slice.to);
            task.down = task.up = slice.missing();
            task.known = &known.back();
            task.seed = seed_++;
            tasks.push_back(task);
            searched.push_back(std::move(slice));
        }
        std::vector<SliceRun> found = workers_.execute(tasks, progress);
        for (std::size_t i = 0; i < found.size(); ++i) {
            solves_ += found[i].solves;
            ++factorizations_;
            // Pairs beyond the slice were not among the known ones, but their slice has them.
            std::vector<Pair> copies;
            take(found[i], searched[i].from, searched[i].to, copies);
            SliceRun extra;
            extra.sigma = found[i].sigma;
            extra.lambda = valuesOf(copies);
            extra.Phi = vectorsOf(copies, n());
            extras_.push_back(std::move(extra));
        }
        return !tasks.empty();
    }

    LowestPairs assembled() const {
        std::vector<Pair> pairs;
        for (const Slice& slice : slices()) {
            if (slice.missing() < 0)
                throw SolverFailure(
                    "the harmonics could not be told apart: more of them were "
                    "found than the inertia of W - sigma D counts");
            pairs.insert(pairs.end(), slice.pairs.begin(), slice.pairs.end());
        }
        const Index c = constants_.count(), found = static_cast<Index>(pairs.size());
        LowestPairs result;
        result.lambda.resize(c + found);
        result.lambda << Eigen::VectorXd::Zero(c), valuesOf(pairs);
        result.Phi.resize(n(), c + found);
        result.Phi.leftCols(c) = constants_.orthonormal();
        for (Index i = 0; i < found; ++i)
            result.Phi.col(c + i) = pairs[static_cast<std::size_t>(i)].phi();
        orthonormalizeClusters(laplacian_.D, result.lambda, result.Phi);
        result.factorizations = factorizations_;
        result.solves = solves_;
        return result;
    }

    const Laplacian& laplacian_;
    const ConstantModes& constants_;
    Index k_;
    SliceWorkers workers_;
    std::vector<std::pair<Index, double>> counts_;  // eigenvalues below a shift, ascending
    std::vector<SliceRun> runs_;                    // by shift
    std::deque<SliceRun> extras_;
    unsigned seed_ = 1;
    int factorizations_ = 0, solves_ = 0;
};

}  // namespace

LowestPairs lowestPairs(const Laplacian& laplacian, const ConstantModes& constants, Index k,
                        const Progress& progress) {
    return Slicing(laplacian, constants, k).compute(progress);
}

}  // namespace spectral
