#include "slice_runs.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "block_lanczos.h"
#include "dense_eigenproblems.h"
#include "errors.h"
#include "mass_products.h"

namespace spectral {

namespace {

/// Vectors of a block. More make a solve cheaper for each, but a space of the same dimension
/// poorer: from 1 to 4 the time changes little, and 2 need the least room for it.
constexpr Index kBlock = 2;

/// Krylov dimensions from check to check of convergence, and at most.
constexpr Index kCheckInterval = 6, kMaxDimension = 160;

/// Krylov dimension at the first check where that number is known: so much for the way from the
/// last pair to its tolerance, and so much for each pair.
constexpr double kDimensionForTolerance = 16.0, kDimensionPerPair = 1.5;

/// Residual of a Ritz pair of the inverted operator, relative to its eigenvalue: at most so many
/// times the residual that a task wants of the purified pair.
constexpr double kRitzResidual = 100.0;

/// Relative distance of eigenvalues that are taken for equal.
constexpr double kEqual = 1e-6;

/// Columns that are purified at a time: small beside the space.
constexpr Index kColumns = 8;

/// Length of what is left of a purified vector beside the known ones, if it is none of them.
constexpr double kNew = 0.5;

constexpr const char* kStage = "computing the harmonics";

/// The known pairs of (W - sigma D)^-1 D.
KnownPairs knownOf(const SliceTask& task, PairStore& found, double sigma) {
    KnownPairs known{found.vectors(task.firstKnown, task.known), Eigen::VectorXd(task.known)};
    for (Index i = 0; i < task.known; ++i)
        known.values[i] = 1.0 / (found.lambda(task.firstKnown + i) - sigma);
    return known;
}

/// A Lanczos run with (W - sigma D)^-1 D on the complement of the constants and of known vectors.
class SliceLanczos {
  public:
    /// @param Q  storage for the basis of the space: n rows, and columns for its largest dimension.
    SliceLanczos(const Laplacian& laplacian, const ConstantModes& constants,
                 const ShiftedLdlt& factor, const SliceTask& task, PairStore& found,
                 Eigen::MatrixXd& Q)
        : laplacian_(laplacian),
          constants_(constants),
          factor_(factor),
          task_(task),
          found_(found),
          known_(knownOf(task, found, factor.shift())),
          apply_([this](const Eigen::MatrixXd& U) { return inverse(U); }),
          Q_(Q),
          lanczos_(apply_, laplacian.D, known_, kBlock, task.seed, Q) {}

    Index dimension() const { return lanczos_.dimension(); }
    bool exhausted() const { return lanczos_.exhausted(); }
    void extend() { lanczos_.extend(); }
    int solves() const { return solves_; }

    /// Looks at the Ritz pairs, counted from the shift on up to the first that has not converged.
    void examine() {
        const Index m = dimension();
        if (m == 0) return;
        const Eigen::MatrixXd T = lanczos_.T();
        theta_.resize(m);
        Z_.resize(m, m);
        if (!denseEigenproblems().symmetric(T.data(), m, theta_.data(), Z_.data()))
            throw SolverFailure("the eigenproblem of the Krylov space did not converge");
        residuals_ = lanczos_.residuals(Z_);
        // theta = 1 / (lambda - sigma): the ends of its range are next to the shift. Between
        // -1 / sigma and 0 lambda would be negative: round-off.
        const double least = -1.0 / factor_.shift();
        Index down = 0, up = 0;
        while (down < m && theta_[down] < least && isConverged(down)) ++down;
        while (up < m && theta_[m - 1 - up] > 0.0 && isConverged(m - 1 - up)) ++up;
        // Below the shift lambda falls as theta rises towards 0; above it lambda rises as theta
        // falls.
        lambda_.resize(down + up);
        for (Index i = 0; i < down; ++i) lambda_[i] = factor_.shift() + 1.0 / theta_[down - 1 - i];
        for (Index i = 0; i < up; ++i)
            lambda_[down + i] = factor_.shift() + 1.0 / theta_[m - 1 - i];
        // An edge is reached by a pair beyond it. Below the edge at 0 there is none: it is reached
        // when no pair that has not converged is left. An invariant space has a pair of every
        // eigenvalue that is not known: there is nothing beyond what it holds.
        reachedFrom_ = task_.from > 0.0 ? down > 0 && lambda_[0] < task_.from - task_.overlap
                                        : !(down < m && theta_[down] < least);
        reachedTo_ = up > 0 && lambda_[down + up - 1] > task_.to + task_.overlap;
        if (lanczos_.isWhole()) reachedFrom_ = reachedTo_ = true;
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

    /// Columns of Z of the converged pairs: of those in the slice, where their number is known,
    /// else of those in its covered part.
    std::vector<Index> converged() const {
        const bool all = task_.missing > 0;
        const double from = all ? task_.from : coveredFrom(), to = all ? task_.to : coveredTo();
        std::vector<Index> columns;
        for (Index i = 0; i < theta_.size(); ++i) {
            const double lambda = factor_.shift() + 1.0 / theta_[i];
            if (lambda >= from && lambda < to && isConverged(i)) columns.push_back(i);
        }
        return columns;
    }

    /// Puts the converged pairs into the store; ends the recurrence.
    void deliver() {
        std::vector<Index> taken = converged();
        // From the shift on outwards: the first ones have the smallest errors.
        std::stable_sort(taken.begin(), taken.end(), [this](Index a, Index b) {
            return std::abs(theta_[a]) > std::abs(theta_[b]);
        });
        const Index count = static_cast<Index>(taken.size());
        if (count == 0) return;
        Eigen::MatrixXd Z(dimension(), count);
        Eigen::VectorXd lambda(count);
        for (Index i = 0; i < count; ++i) {
            Z.col(i) = Z_.col(taken[static_cast<std::size_t>(i)]);
            lambda[i] = factor_.shift() + 1.0 / theta_[taken[static_cast<std::size_t>(i)]];
        }
        multiplyInPlace(Q_.leftCols(dimension()), Z);
        const Index first = found_.claim(lambda, task_.seed);
        auto Phi = found_.vectors(first, count);
        for (Index i = 0; i < count; i += kColumns) {
            // Purification: one more inverse iteration takes away what is not in the Krylov space.
            const Index columns = std::min(kColumns, count - i);
            Eigen::MatrixXd phi = inverse(Q_.middleCols(i, columns));
            for (Index j = 0; j < columns; ++j)
                phi.col(j) /= std::sqrt(phi.col(j).cwiseAbs2().dot(laplacian_.D));
            Phi.middleCols(i, columns) = phi;
        }
        orthonormalize(Phi);
    }

  private:
    /// (W - sigma D)^-1 D U
    Eigen::MatrixXd inverse(const Eigen::Ref<const Eigen::MatrixXd>& U) {
        solves_ += static_cast<int>(U.cols());
        Eigen::MatrixXd X = U;
        factor_.applyResolvent(laplacian_.D, X);
        constants_.remove(X);
        return X;
    }

    /// D-orthonormalizes vectors of length 1, in their order, on the complement of the known ones.
    void orthonormalize(Eigen::Ref<Eigen::MatrixXd> Phi) const {
        const Eigen::VectorXd& D = laplacian_.D;
        subtractProduct(known_.vectors, innerProducts(known_.vectors, D, Phi), Phi);
        const Eigen::MatrixXd gram = innerProducts(Phi, D, Phi);
        const Eigen::LLT<Eigen::MatrixXd> llt(gram);
        const Eigen::MatrixXd R = llt.matrixU();
        if (llt.info() != Eigen::Success || (R.diagonal().array() < kNew).any())
            throw SolverFailure(
                "the harmonics could not be told apart: one has been found a second time");
        multiplyInPlace(Phi,
                        llt.matrixU().solve(Eigen::MatrixXd::Identity(gram.rows(), gram.cols())));
    }

    /// Purified, a pair with residual r = |M y - theta y| has |W phi - lambda D phi| = r / theta^2.
    bool isConverged(Index i) const {
        const double theta = std::abs(theta_[i]), lambda = factor_.shift() + 1.0 / theta_[i];
        const bool isWithin = lambda >= task_.from && lambda < task_.to;
        const double wanted = isWithin ? task_.residual : task_.residualBeyond;
        return residuals_[i] <= wanted * std::min(kRitzResidual, lambda * theta) * theta;
    }

    const Laplacian& laplacian_;
    const ConstantModes& constants_;
    const ShiftedLdlt& factor_;
    const SliceTask& task_;
    PairStore& found_;
    KnownPairs known_;
    int solves_ = 0;
    BlockLanczos::Operator apply_;
    Eigen::MatrixXd& Q_;
    BlockLanczos lanczos_;
    Eigen::VectorXd theta_, residuals_;  // of the Ritz pairs
    Eigen::MatrixXd Z_;                  // their coordinates in Q
    Eigen::VectorXd lambda_;             // of the converged ones from the shift on, ascending
    bool reachedFrom_ = false, reachedTo_ = false;
};

/// Krylov dimension at which a run is first looked at.
Index firstCheck(const SliceTask& task) {
    if (task.missing == 0) return task.firstCheck;
    return static_cast<Index>(kDimensionForTolerance +
                              kDimensionPerPair * static_cast<double>(task.missing));
}

SliceRun runOf(const Laplacian& laplacian, const ConstantModes& constants, ShiftedLdlt& factor,
               Eigen::MatrixXd& Q, const SliceTask& task, PairStore& found,
               const StopPoint& stopPoint) {
    SliceRun run;
    factor.factorize(laplacian, task.sigma);
    run.sigma = factor.shift();
    run.below = factor.eigenvaluesBelow();
    SliceLanczos lanczos(laplacian, constants, factor, task, found, Q);
    for (Index check = firstCheck(task); !lanczos.exhausted();) {
        stopPoint();
        lanczos.extend();
        if (lanczos.dimension() < check && !lanczos.exhausted()) continue;
        lanczos.examine();
        if (task.missing > 0 ? static_cast<Index>(lanczos.converged().size()) >= task.missing
                             : lanczos.reachedFrom() && lanczos.reachedTo())
            break;
        check = lanczos.dimension() + kCheckInterval;
    }
    run.coveredFrom = lanczos.coveredFrom();
    run.coveredTo = lanczos.coveredTo();
    lanczos.deliver();
    run.solves = lanczos.solves();
    return run;
}

}  // namespace

SliceWorkers::SliceWorkers(const Laplacian& laplacian, const ConstantModes& constants,
                           std::vector<ShiftedLdlt>& factors)
    : laplacian_(laplacian),
      constants_(constants),
      factors_(factors),
      spaces_(static_cast<std::size_t>(workerCount())) {
    if (factors_.size() != spaces_.size()) factors_ = std::vector<ShiftedLdlt>(spaces_.size());
}

SliceRun SliceWorkers::run(const SliceTask& task, int worker, PairStore& found,
                           const StopPoint& stopPoint) {
    Eigen::MatrixXd& Q = spaces_[static_cast<std::size_t>(worker)];
    const Index dimension = task.dimension > 0 ? task.dimension : kMaxDimension;
    Q.resize(laplacian_.D.size(), std::min(laplacian_.D.size(), dimension));
    return runOf(laplacian_, constants_, factor(worker), Q, task, found, stopPoint);
}

std::vector<Index> SliceWorkers::count(const std::vector<double>& sigmas,
                                       const Progress& progress) {
    std::vector<Index> below(sigmas.size());
    runInParallel(
        static_cast<Index>(sigmas.size()),
        [&](Index task, int worker, const StopPoint&) {
            const auto t = static_cast<std::size_t>(task);
            factor(worker).factorize(laplacian_, sigmas[t]);
            below[t] = factor(worker).eigenvaluesBelow();
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
