#include "spectrum_slicing.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "errors.h"
#include "indefinite_factor.h"

namespace spectral {

namespace {

/// Eigenvalues from one shift to the next. Fewer cost more factorizations, more a Krylov space
/// whose orthogonalization costs the square of its dimension.
constexpr Index kSpacing = 26;

/// Pairs that a run finds beyond half the way to the next shift, so that neighbours overlap.
constexpr Index kOverlap = 4;

/// Krylov dimensions: at the first check of convergence, from check to check, and at most.
constexpr Index kFirstCheck = 56, kCheckInterval = 8, kMaxDimension = 160;

/// Residual of a Ritz pair of the shift-inverted operator, relative to its eigenvalue. The pairs
/// are purified afterwards, which squares it.
constexpr double kTolerance = 1e-8;

/// Relative distance of eigenvalues of whose vectors nothing but orthogonality is well defined.
constexpr double kEqual = 1e-6;

/// From one report of progress to the next, at most.
constexpr std::chrono::milliseconds kReportInterval{100};

/// Waves of runs after which something must be wrong.
constexpr int kMaxWaves = 12;

/// One run: a shift, and the pairs round it.
struct Run {
    double sigma = 0.0;
    Index below = 0;         // eigenvalues below sigma, by inertia
    Eigen::VectorXd lambda;  // ascending
    Eigen::MatrixXd Phi;     // n x lambda.size()
    int solves = 0;

    double lowest() const { return lambda.size() > 0 ? lambda[0] : sigma; }
    double highest() const { return lambda.size() > 0 ? lambda[lambda.size() - 1] : sigma; }
};

/// What a run is to find.
struct Task {
    double sigma = 0.0;
    Index down = 0, up = 0;             // pairs below and above the shift, none of them `known`
    const Eigen::MatrixXd* known = {};  // D-orthonormal vectors that it is not to find again
    unsigned seed = 0;
};

/// The Lanczos recurrence of M = D^1/2 (W - sigma D)^-1 D^1/2 from one start vector, on the
/// complement of the constants and of known vectors, with full reorthogonalization.
class SliceLanczos {
  public:
    SliceLanczos(const Laplacian& laplacian, const ConstantModes& constants,
                 const IndefiniteFactor& factor, const Task& task)
        : laplacian_(laplacian),
          constants_(constants),
          factor_(factor),
          known_(task.known),
          sqrtD_(laplacian.D.cwiseSqrt()),
          Q_(sqrtD_.size(), std::min<Index>(kFirstCheck + 3 * kCheckInterval, sqrtD_.size())) {
        std::mt19937 random(task.seed);
        std::uniform_real_distribution<double> uniform(-1.0, 1.0);
        Eigen::MatrixXd start(sqrtD_.size(), 1);
        for (Index i = 0; i < start.rows(); ++i) start(i, 0) = uniform(random);
        project(start);
        Q_.col(0) = sqrtD_.cwiseProduct(start.col(0));
        Q_.col(0).normalize();
    }

    Index dimension() const { return static_cast<Index>(alpha_.size()); }
    bool exhausted() const { return exhausted_; }

    void extend() {
        const Index j = dimension();
        Eigen::MatrixXd u = sqrtD_.cwiseProduct(Q_.col(j));
        u = factor_.solve(u);
        project(u);
        Eigen::VectorXd w = sqrtD_.cwiseProduct(u.col(0));
        const double scale = w.norm();
        alpha_.push_back(Q_.col(j).dot(w));
        w -= alpha_.back() * Q_.col(j);
        if (j > 0) w -= beta_.back() * Q_.col(j - 1);
        const double before = w.norm();
        reorthogonalize(w);
        if (w.norm() < 0.5 * before) reorthogonalize(w);
        const double beta = w.norm();
        beta_.push_back(beta);
        if (!(beta > 1e-13 * scale) || j + 1 == Q_.rows()) {
            beta_.back() = 0.0;
            exhausted_ = true;
            return;
        }
        if (j + 1 == Q_.cols())
            Q_.conservativeResize(Eigen::NoChange, std::min(Q_.rows(), Q_.cols() + 32));
        Q_.col(j + 1) = w / beta;
    }

    /// Looks at the Ritz pairs; returns how many have converged below and above the shift, counted
    /// from the shift on up to the first that has not.
    std::pair<Index, Index> converged() {
        const Index m = dimension();
        ritz_.computeFromTridiagonal(Eigen::Map<const Eigen::VectorXd>(alpha_.data(), m),
                                     Eigen::Map<const Eigen::VectorXd>(beta_.data(), m - 1));
        if (ritz_.info() != Eigen::Success)
            throw SolverFailure("the eigenproblem of a Krylov space did not converge");
        // theta = 1 / (lambda - sigma): the ends of its range are next to the shift.
        // Between -1 / sigma and 0 it would be negative: round-off.
        Index down = 0, up = 0;
        const double least = -1.0 / factor_.shift();
        while (down < m && ritz_.eigenvalues()[down] < least && isConverged(down)) ++down;
        while (up < m && ritz_.eigenvalues()[m - 1 - up] > 0.0 && isConverged(m - 1 - up)) ++up;
        return {down, up};
    }

    /// The first `down` and `up` Ritz pairs on either side of the shift, in ascending order.
    void pairs(Index down, Index up, Run& run) const {
        const Index m = dimension();
        Eigen::MatrixXd Z(m, down + up);
        Eigen::VectorXd theta(down + up);
        // Below the shift lambda falls as theta rises towards 0; above it lambda rises as theta
        // falls.
        for (Index i = 0; i < down; ++i) {
            Z.col(i) = ritz_.eigenvectors().col(down - 1 - i);
            theta[i] = ritz_.eigenvalues()[down - 1 - i];
        }
        for (Index i = 0; i < up; ++i) {
            Z.col(down + i) = ritz_.eigenvectors().col(m - 1 - i);
            theta[down + i] = ritz_.eigenvalues()[m - 1 - i];
        }
        run.lambda = run.sigma + theta.cwiseInverse().array();
        // Purification: one more inverse iteration takes away what is not in the Krylov space.
        const Eigen::MatrixXd ritz = Q_.leftCols(m) * Z;
        run.Phi = factor_.solve(sqrtD_.asDiagonal() * ritz);
        project(run.Phi);
        for (Index i = 0; i < run.Phi.cols(); ++i)
            run.Phi.col(i) /= sqrtD_.cwiseProduct(run.Phi.col(i)).norm();
    }

  private:
    void project(Eigen::MatrixXd& u) const {
        constants_.remove(u);
        if (known_ != nullptr && known_->cols() > 0)
            u -= *known_ * (known_->transpose() * (laplacian_.D.asDiagonal() * u));
    }

    void reorthogonalize(Eigen::VectorXd& w) const {
        const auto Q = Q_.leftCols(dimension());
        const Eigen::VectorXd overlap = Q.transpose() * w;
        w.noalias() -= Q * overlap;
    }

    bool isConverged(Index i) const {
        const double residual = beta_.back() * std::abs(ritz_.eigenvectors()(dimension() - 1, i));
        return residual <= kTolerance * std::abs(ritz_.eigenvalues()[i]);
    }

    const Laplacian& laplacian_;
    const ConstantModes& constants_;
    const IndefiniteFactor& factor_;
    const Eigen::MatrixXd* known_;
    Eigen::VectorXd sqrtD_;
    Eigen::MatrixXd Q_;  // orthonormal
    std::vector<double> alpha_, beta_;
    bool exhausted_ = false;
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> ritz_;
};

Run runOf(const Laplacian& laplacian, const ConstantModes& constants, IndefiniteFactor& factor,
          const Task& task, const std::function<void()>& tick) {
    Run run;
    factor.factorize(task.sigma);
    run.sigma = factor.shift();
    run.below = factor.eigenvaluesBelow();
    tick();
    if (task.down + task.up == 0) return run;  // a count was all that was asked for
    SliceLanczos lanczos(laplacian, constants, factor, task);
    Index check = std::min(kFirstCheck, 2 * (task.down + task.up) + 8);
    for (;;) {
        lanczos.extend();
        tick();
        if (!lanczos.exhausted() && lanczos.dimension() < check) continue;
        const auto [down, up] = lanczos.converged();
        if ((down >= task.down && up >= task.up) || lanczos.exhausted() ||
            lanczos.dimension() >= kMaxDimension) {
            lanczos.pairs(down, up, run);
            run.solves = static_cast<int>(lanczos.dimension() + down + up);
            return run;
        }
        check = lanczos.dimension() + kCheckInterval;
    }
}

/// Executes tasks on all cores.
class Workers {
  public:
    Workers(const Laplacian& laplacian, const ConstantModes& constants)
        : laplacian_(laplacian),
          constants_(constants),
          factors_(std::max(1U, std::thread::hardware_concurrency())) {}

    /// Only the calling thread reports progress, and it does nothing else: whatever the others do,
    /// the caller can stop them at once.
    std::vector<Run> execute(const std::vector<Task>& tasks, const Progress& progress) {
        std::vector<Run> runs(tasks.size());
        std::atomic<std::size_t> next{0};
        std::atomic<bool> stop{false};
        std::exception_ptr failure;
        std::size_t finished = 0;
        std::mutex mutex;  // guards failure and finished
        std::condition_variable changed;
        const auto work = [&](std::unique_ptr<IndefiniteFactor>& factor) {
            try {
                if (!factor) factor = std::make_unique<IndefiniteFactor>(laplacian_);
                for (std::size_t t; !stop && (t = next++) < tasks.size();) {
                    runs[t] = runOf(laplacian_, constants_, *factor, tasks[t], [&] {
                        if (stop) throw Cancelled();
                    });
                    const std::lock_guard<std::mutex> lock(mutex);
                    ++finished;
                    changed.notify_one();
                }
            } catch (...) {
                const std::lock_guard<std::mutex> lock(mutex);
                if (!stop) failure = std::current_exception();
                stop = true;
                changed.notify_one();
            }
        };
        std::vector<std::thread> threads;
        for (std::size_t w = 0; w < std::min(factors_.size(), tasks.size()); ++w)
            threads.emplace_back(work, std::ref(factors_[w]));
        try {
            std::unique_lock<std::mutex> lock(mutex);
            while (finished < tasks.size() && !stop) {
                const double done =
                    static_cast<double>(finished) / static_cast<double>(tasks.size());
                lock.unlock();
                progress.report(done, "computing the harmonics");
                lock.lock();
                if (finished < tasks.size() && !stop) changed.wait_for(lock, kReportInterval);
            }
        } catch (...) {
            const std::lock_guard<std::mutex> lock(mutex);
            failure = std::current_exception();
            stop = true;
        }
        for (std::thread& thread : threads) thread.join();
        if (failure) std::rethrow_exception(failure);
        return runs;
    }

  private:
    const Laplacian& laplacian_;
    const ConstantModes& constants_;
    std::vector<std::unique_ptr<IndefiniteFactor>> factors_;
};

/// An eigenpair of a run.
struct Pair {
    const Run* run;
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
void take(const Run& run, double from, double to, std::vector<Pair>& pairs) {
    for (Index i = 0; i < run.lambda.size(); ++i)
        if (run.lambda[i] > from && run.lambda[i] < to) pairs.push_back({&run, i});
}

/// Where pairs of the left run end and those of the right one begin: in the widest gap of the
/// eigenvalues that both have found, so that no group of equal ones is torn apart.
double splitOf(const Run& left, const Run& right) {
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
Slice sliceBetween(const Run* left, const Run& right, Index constants,
                   const std::deque<Run>& extras) {
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
    for (const Run& extra : extras) take(extra, slice.from, slice.to, slice.pairs);
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
        std::vector<Task> tasks = firstTasks();
        double done = 0.05;
        for (int wave = 0;; ++wave) {
            const double end = done + 0.8 * (1.0 - done);
            for (Run& run : workers_.execute(tasks, progress.part(done, end))) {
                solves_ += run.solves;
                ++factorizations_;
                runs_.push_back(std::move(run));
            }
            done = end;
            std::sort(runs_.begin(), runs_.end(),
                      [](const Run& a, const Run& b) { return a.sigma < b.sigma; });
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
        std::vector<Task> tasks(2);
        tasks[0].sigma = 0.25 * top;
        tasks[1].sigma = top;
        counts_.emplace_back(constants_.count(), 0.0);
        for (const Run& run : workers_.execute(tasks, progress)) {
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

    std::vector<Task> firstTasks() {
        const double span = static_cast<double>(k_ - constants_.count());
        const auto runs = std::max<Index>(1, (k_ - constants_.count() + kSpacing / 2) / kSpacing);
        const double spacing = span / (static_cast<double>(runs) - 0.5);
        const Index half = static_cast<Index>(std::ceil(0.5 * spacing)) + kOverlap;
        std::vector<Task> tasks(static_cast<std::size_t>(runs));
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
    std::vector<Task> tasksForGaps() {
        std::vector<Task> tasks;
        for (const Slice& slice : slices()) {
            if (!slice.gap || slice.missing() <= 0) continue;
            Task task;
            task.sigma = 0.5 * (slice.gapFrom + slice.gapTo);
            task.down = task.up = std::min(kSpacing, slice.missing()) / 2 + kOverlap;
            task.seed = seed_++;
            tasks.push_back(task);
        }
        const Index below = runs_.back().below;
        if (below < k_) {
            Task task;
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
        std::vector<Task> tasks;
        std::vector<Slice> searched;
        std::deque<Eigen::MatrixXd> known;
        for (Slice& slice : slices()) {
            if (slice.missing() <= 0) continue;
            Eigen::MatrixXd vectors = vectorsOf(slice.pairs, n());
            orthonormalizeClusters(laplacian_.D, valuesOf(slice.pairs), vectors);
            known.push_back(std::move(vectors));
            Task task;
            task.sigma = 0.5 * (slice.from + slice.to);
            task.down = task.up = slice.missing();
            task.known = &known.back();
            task.seed = seed_++;
            tasks.push_back(task);
            searched.push_back(std::move(slice));
        }
        std::vector<Run> found = workers_.execute(tasks, progress);
        for (std::size_t i = 0; i < found.size(); ++i) {
            solves_ += found[i].solves;
            ++factorizations_;
            // Pairs beyond the slice were not among the known ones, but their slice has them.
            std::vector<Pair> copies;
            take(found[i], searched[i].from, searched[i].to, copies);
            Run extra;
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
    Workers workers_;
    std::vector<std::pair<Index, double>> counts_;  // eigenvalues below a shift, ascending
    std::vector<Run> runs_;                         // by shift
    std::deque<Run> extras_;
    unsigned seed_ = 1;
    int factorizations_ = 0, solves_ = 0;
};

}  // namespace

LowestPairs lowestPairs(const Laplacian& laplacian, const ConstantModes& constants, Index k,
                        const Progress& progress) {
    return Slicing(laplacian, constants, k).compute(progress);
}

}  // namespace spectral
