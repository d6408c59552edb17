#include "slice_runs.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "errors.h"
#include "parallel_tasks.h"

namespace spectral {

namespace {

/// Krylov dimensions: at the first check of convergence, from check to check, and at most.
constexpr Index kFirstCheck = 56, kCheckInterval = 8, kMaxDimension = 160;

/// Residual of a Ritz pair of the shift-inverted operator, relative to its eigenvalue. The pairs
/// are purified afterwards, which lowers it further.
constexpr double kTolerance = 1e-8;

/// The Lanczos recurrence of M = D^1/2 (W - sigma D)^-1 D^1/2 from one start vector, on the
/// complement of the constants and of known vectors, with full reorthogonalization.
class SliceLanczos {
  public:
    SliceLanczos(const Laplacian& laplacian, const ConstantModes& constants,
                 const ShiftedLdlt& factor, const SliceTask& task)
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
    void pairs(Index down, Index up, SliceRun& run) const {
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
    const ShiftedLdlt& factor_;
    const Eigen::MatrixXd* known_;
    Eigen::VectorXd sqrtD_;
    Eigen::MatrixXd Q_;  // orthonormal
    std::vector<double> alpha_, beta_;
    bool exhausted_ = false;
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> ritz_;
};

SliceRun runOf(const Laplacian& laplacian, const ConstantModes& constants, ShiftedLdlt& factor,
               const SliceTask& task, const StopPoint& stopPoint) {
    SliceRun run;
    factor.factorize(laplacian, task.sigma);
    run.sigma = factor.shift();
    run.below = factor.eigenvaluesBelow();
    stopPoint();
    if (task.down + task.up == 0) return run;  // a count was all that was asked for
    SliceLanczos lanczos(laplacian, constants, factor, task);
    Index check = std::min(kFirstCheck, 2 * (task.down + task.up) + 8);
    for (;;) {
        lanczos.extend();
        stopPoint();
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

}  // namespace

SliceWorkers::SliceWorkers(const Laplacian& laplacian, const ConstantModes& constants)
    : laplacian_(laplacian),
      constants_(constants),
      factors_(static_cast<std::size_t>(workerCount())) {}

std::vector<SliceRun> SliceWorkers::execute(const std::vector<SliceTask>& tasks,
                                            const Progress& progress) {
    std::vector<SliceRun> runs(tasks.size());
    runInParallel(
        static_cast<Index>(tasks.size()),
        [&](Index task, int worker, const StopPoint& stopPoint) {
            const auto t = static_cast<std::size_t>(task);
            ShiftedLdlt& factor = factors_[static_cast<std::size_t>(worker)];
            runs[t] = runOf(laplacian_, constants_, factor, tasks[t], stopPoint);
        },
        progress, "computing the harmonics");
    return runs;
}

}  // namespace spectral
