#include "slice_runs.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "errors.h"
#include "tridiagonal.h"

namespace spectral {

namespace {

/// Krylov dimensions: at the first check of convergence, from check to check, and at most.
constexpr Index kFirstCheck = 48, kCheckInterval = 6, kMaxDimension = 160;

/// Residual of a Ritz pair of the shift-inverted operator, relative to its eigenvalue. The pairs
/// are purified afterwards, which lowers it further.
constexpr double kTolerance = 1e-9;

/// Relative distance of eigenvalues that are taken for equal.
constexpr double kEqual = 1e-6;

/// Length of what is left of a vector of an invariant space, beside the vector's own.
constexpr double kTiny = 1e-13;

/// Rows that are rotated, and columns that are purified, at a time: small beside the space.
constexpr Index kRows = 512, kColumns = 4;

constexpr const char* kStage = "computing the harmonics";

/// The Lanczos recurrence of M = D^1/2 (W - sigma D)^-1 D^1/2 from one start vector, on the
/// complement of the constants and of known vectors, with full reorthogonalization.
class SliceLanczos {
  public:
    /// @param Q  storage for the basis of the space: n rows, and columns for its largest dimension.
    SliceLanczos(const Laplacian& laplacian, const ConstantModes& constants,
                 const ShiftedLdlt& factor, const SliceTask& task, Eigen::MatrixXd& Q)
        : laplacian_(laplacian),
          constants_(constants),
          factor_(factor),
          task_(task),
          sqrtD_(laplacian.D.cwiseSqrt()),
          Q_(Q) {
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
        if (!(beta > kTiny * scale) || j + 1 == Q_.cols()) {
            invariant_ = !(beta > kTiny * scale);
            if (invariant_) beta_.back() = 0.0;
            exhausted_ = true;
            return;
        }
        Q_.col(j + 1) = w / beta;
    }

    /// Looks at the Ritz pairs, counted from the shift on up to the first that has not converged.
    void examine() {
        const Index m = dimension();
        ritz_ = eigenpairsOfTridiagonal(alpha_, beta_);
        // theta = 1 / (lambda - sigma): the ends of its range are next to the shift. Between
        // -1 / sigma and 0 lambda would be negative: round-off.
        const Eigen::VectorXd& theta = ritz_.values;
        const double least = -1.0 / factor_.shift();
        Index down = 0, up = 0;
        while (down < m && theta[down] < least && isConverged(down)) ++down;
        while (up < m && theta[m - 1 - up] > 0.0 && isConverged(m - 1 - up)) ++up;
        // Below the shift lambda falls as theta rises towards 0; above it lambda rises as theta
        // falls.
        ritzOf_.clear();
        for (Index i = down - 1; i >= 0; --i) ritzOf_.push_back(i);
        for (Index i = 0; i < up; ++i) ritzOf_.push_back(m - 1 - i);
        lambda_.resize(down + up);
        for (Index i = 0; i < lambda_.size(); ++i)
            lambda_[i] = factor_.shift() + 1.0 / theta[ritzOf_[static_cast<std::size_t>(i)]];
        // An edge is reached by a pair beyond it. Below the edge at 0 there is none: it is reached
        // when no pair that has not converged is left. An invariant space has a pair of every
        // eigenvalue that is not known: there is nothing beyond what it holds.
        reachedFrom_ = task_.from > 0.0 ? down > 0 && lambda_[0] < task_.from - task_.overlap
                                        : !(down < m && theta[down] < least);
        reachedTo_ = up > 0 && lambda_[down + up - 1] > task_.to + task_.overlap;
        if (invariant_) reachedFrom_ = reachedTo_ = true;
    }

    bool reachedFrom() const { return reachedFrom_; }
    bool reachedTo() const { return reachedTo_; }

    /// The part of the slice that converged pairs cover.
    double coveredFrom() const {
        if (reachedFrom_) return task_.from;
        const bool any = lambda_.size() > 0 && lambda_[0] < factor_.shift();
        return std::max(task_.from, any ? lambda_[0] * (1.0 - kEqual) : factor_.shift());
    }
    double coveredTo() const {
        if (reachedTo_) return task_.to;
        const Index c = lambda_.size();
        const bool any = c > 0 && lambda_[c - 1] > factor_.shift();
        return std::min(task_.to, any ? lambda_[c - 1] * (1.0 + kEqual) : factor_.shift());
    }

    /// The converged pairs of the covered part.
    std::vector<Index> covered() const {
        const double from = coveredFrom(), to = coveredTo();
        std::vector<Index> pairs;
        for (Index i = 0; i < lambda_.size(); ++i)
            if (lambda_[i] >= from && lambda_[i] < to) pairs.push_back(i);
        return pairs;
    }

    /// Puts the covered pairs into the store; ends the recurrence. Returns their number.
    Index deliver(PairStore& store) {
        const std::vector<Index> taken = covered();
        const Index m = dimension(), count = static_cast<Index>(taken.size());
        Eigen::MatrixXd Z(m, count);
        Eigen::VectorXd lambda(count);
        for (Index i = 0; i < count; ++i) {
            const Index pair = taken[static_cast<std::size_t>(i)];
            Z.col(i) = ritz_.vectors.col(ritzOf_[static_cast<std::size_t>(pair)]);
            lambda[i] = lambda_[pair];
        }
        const Index n = Q_.rows(), first = store.claim(lambda, task_.seed);
        for (Index row = 0; row < n; row += kRows) {  // Q <- Q Z, in place
            const Index rows = std::min(kRows, n - row);
            const Eigen::MatrixXd ritz = Q_.block(row, 0, rows, m) * Z;
            Q_.block(row, 0, rows, count) = ritz;
        }
        for (Index i = 0; i < count; i += kColumns) {
            // Purification: one more inverse iteration takes away what is not in the Krylov space.
            const Index columns = std::min(kColumns, count - i);
            Eigen::MatrixXd phi = factor_.solve(sqrtD_.asDiagonal() * Q_.middleCols(i, columns));
            project(phi);
            for (Index j = 0; j < columns; ++j)
                phi.col(j) /= sqrtD_.cwiseProduct(phi.col(j)).norm();
            store.vectors(first + i, columns) = phi;
        }
        return count;
    }

  private:
    void project(Eigen::MatrixXd& u) const {
        constants_.remove(u);
        if (task_.known.cols() > 0)
            u -= task_.known * (task_.known.transpose() * (laplacian_.D.asDiagonal() * u));
    }

    void reorthogonalize(Eigen::VectorXd& w) const {
        const auto Q = Q_.leftCols(dimension());
        const Eigen::VectorXd overlap = Q.transpose() * w;
        w.noalias() -= Q * overlap;
    }

    bool isConverged(Index i) const {
        const double residual = beta_.back() * std::abs(ritz_.vectors(dimension() - 1, i));
        return residual <= kTolerance * std::abs(ritz_.values[i]);
    }

    const Laplacian& laplacian_;
    const ConstantModes& constants_;
    const ShiftedLdlt& factor_;
    const SliceTask& task_;
    Eigen::VectorXd sqrtD_;
    Eigen::MatrixXd& Q_;  // its first columns are orthonormal
    std::vector<double> alpha_, beta_;
    bool exhausted_ = false, invariant_ = false;
    TridiagonalEigenpairs ritz_;
    Eigen::VectorXd lambda_;     // of the converged Ritz pairs, ascending
    std::vector<Index> ritzOf_;  // their columns in ritz_
    bool reachedFrom_ = false, reachedTo_ = false;
};

SliceRun runOf(const Laplacian& laplacian, const ConstantModes& constants, ShiftedLdlt& factor,
               Eigen::MatrixXd& Q, const SliceTask& task, PairStore& found,
               const StopPoint& stopPoint) {
    SliceRun run;
    factor.factorize(laplacian, task.sigma);
    run.sigma = factor.shift();
    run.below = factor.eigenvaluesBelow();
    SliceLanczos lanczos(laplacian, constants, factor, task, Q);
    for (Index check = kFirstCheck;;) {
        stopPoint();
        lanczos.extend();
        if (lanczos.dimension() < check && !lanczos.exhausted()) continue;
        lanczos.examine();
        // Beyond the first copy of a multiple eigenvalue the others come in by round-off.
        const bool done = lanczos.reachedFrom() && lanczos.reachedTo() &&
                          static_cast<Index>(lanczos.covered().size()) >= task.missing;
        if (done || lanczos.exhausted()) break;
        check = lanczos.dimension() + kCheckInterval;
    }
    run.coveredFrom = lanczos.coveredFrom();
    run.coveredTo = lanczos.coveredTo();
    run.solves = static_cast<int>(lanczos.dimension() + lanczos.deliver(found));
    return run;
}

}  // namespace

SliceWorkers::SliceWorkers(const Laplacian& laplacian, const ConstantModes& constants)
    : laplacian_(laplacian),
      constants_(constants),
      workspaces_(static_cast<std::size_t>(workerCount())) {}

SliceRun SliceWorkers::run(const SliceTask& task, int worker, PairStore& found,
                           const StopPoint& stopPoint) {
    Workspace& workspace = workspaces_[static_cast<std::size_t>(worker)];
    workspace.Q.resize(laplacian_.D.size(), std::min(laplacian_.D.size(), kMaxDimension));
    return runOf(laplacian_, constants_, workspace.factor, workspace.Q, task, found, stopPoint);
}

std::vector<Index> SliceWorkers::count(const std::vector<double>& sigmas,
                                       const Progress& progress) {
    std::vector<Index> below(sigmas.size());
    runInParallel(
        static_cast<Index>(sigmas.size()),
        [&](Index task, int worker, const StopPoint&) {
            const auto t = static_cast<std::size_t>(task);
            ShiftedLdlt& factor = workspaces_[static_cast<std::size_t>(worker)].factor;
            factor.factorize(laplacian_, sigmas[t]);
            below[t] = factor.eigenvaluesBelow();
        },
        progress, kStage);
    return below;
}

std::vector<SliceRun> SliceWorkers::execute(const std::vector<SliceTask>& tasks, PairStore& found,
                                            const Progress& progress) {
    std::vector<SliceRun> runs(tasks.size());
    runInParallel(
        static_cast<Index>(tasks.size()),
        [&](Index task, int worker, const StopPoint& stopPoint) {
            const auto t = static_cast<std::size_t>(task);
            runs[t] = run(tasks[t], worker, found, stopPoint);
        },
        progress, kStage);
    return runs;
}

}  // namespace spectral
