#include "basis_update.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "basis_certificate.h"
#include "errors.h"
#include "mass_products.h"
#include "pair_store.h"
#include "parallel_tasks.h"
#include "rayleigh_ritz.h"
#include "slice_iteration.h"
#include "slice_runs.h"
#include "symmetric_product.h"

namespace spectral {

namespace {

/// Vectors of a slice, about: they share a factorization, which costs as much as 50 solves.
constexpr Index kSliceWidth = 32;

/// Harmonics next to the cut that are computed anew, below and above it, and how many of the
/// previous ones in their place are iterated all the same, for what has moved.
constexpr Index kEdgeBelow = 16, kEdgeAbove = 14, kMoved = 8;

/// How far beyond these the pairs of the run have to converge, in mean distances of eigenvalues.
constexpr double kOverlap = 1.0;

/// Fewer harmonics than this are computed from nothing as quickly.
constexpr Index kFewest = 64;

/// Square of the length that others leave of a unit vector, below which it is none of its own.
constexpr double kDependent = 1e-3;

/// Relative error of an eigenvalue that the count by inertia forgives beside a shift.
constexpr double kCountTolerance = 1e-4;

/// Columns that a task takes: few beside the basis, enough for products at full speed.
constexpr Index kColumns = 48;

constexpr const char* kStage = "updating the harmonics";

/// Where the inertia of a factorization has counted the eigenvalues.
struct Count {
    double sigma = 0.0;
    Index below = 0;
};

/// Whether lambda has as many entries below each shift as there are eigenvalues, if that is less
/// than `size`.
bool agree(const Eigen::VectorXd& lambda, Index size, const std::vector<Count>& counts) {
    const auto below = [&](double bound) { return (lambda.array() < bound).count(); };
    return std::all_of(counts.begin(), counts.end(), [&](const Count& count) {
        return std::min(size, count.below) >=
                   std::min(size, below(count.sigma * (1.0 - kCountTolerance))) &&
               std::min(size, count.below) <=
                   std::min(size, below(count.sigma * (1.0 + kCountTolerance)));
    });
}

/// An update at work. The spectrum has three parts: the constant modes; the interior, what is
/// iterated towards; and the edge, the pairs next to the cut on both sides, computed anew. The
/// candidates for the interior are the columns of the basis beyond the constant modes.
class Update {
  public:
    Update(const Laplacian& laplacian, const ConstantModes& constants, Index k,
           HarmonicBasis& basis, BasisUpdateResult& result)
        : laplacian_(laplacian),
          constants_(constants),
          k_(k),
          basis_(basis),
          result_(result),
          workers_(laplacian, constants),
          // More would mean that the spectrum has changed too much.
          edge_(laplacian.D.size(), 2 * (basis.size() - k + kEdgeBelow + kEdgeAbove)) {
        basis_.Phi.leftCols(c()) = constants_.orthonormal();
    }

    /// Looks at the candidates under the new Laplacian: takes them in the order of their Rayleigh
    /// quotients. Returns their mean residual.
    double sortCandidates(const Progress& progress) {
        const Index all = basis_.Phi.cols() - c();
        const Eigen::VectorXd &D = laplacian_.D, invSqrtD = D.cwiseSqrt().cwiseInverse();
        Eigen::VectorXd residual(all);
        quotient_.resize(all);
        runInParallel(
            (all + kColumns - 1) / kColumns,
            [&](Index task, int, const StopPoint&) {
                const Index first = task * kColumns, count = std::min(kColumns, all - first);
                Eigen::MatrixXd S = basis_.Phi.middleCols(c() + first, count);
                constants_.remove(S);
                const Eigen::MatrixXd WS = symmetricProduct(laplacian_.W, S);
                for (Index j = 0; j < count; ++j) {
                    const double squared = S.col(j).cwiseAbs2().dot(D);
                    const double quotient = S.col(j).dot(WS.col(j)) / squared;
                    quotient_[first + j] = quotient;
                    residual[first + j] =
                        invSqrtD.cwiseProduct(WS.col(j) - quotient * D.cwiseProduct(S.col(j)))
                            .norm() /
                        (quotient * std::sqrt(squared));
                }
            },
            progress, kStage);
        order_.resize(static_cast<std::size_t>(all));
        std::iota(order_.begin(), order_.end(), Index{0});
        std::stable_sort(order_.begin(), order_.end(),
                         [&](Index a, Index b) { return quotient_[a] < quotient_[b]; });
        return residual.mean();
    }

    /// Computes the edge and, beside it, iterates the interior.
    void compute(const Progress& progress) {
        const Eigen::MatrixXd none;
        const SliceTask edge = edgeTask(none);
        beyond_ = edge.to;
        iterated_ = wanted() - kEdgeBelow + kMoved;
        counts_.resize(static_cast<std::size_t>(slices()));
        SliceRun run;
        runInParallel(
            1 + slices(),
            [&](Index task, int worker, const StopPoint& stopPoint) {
                // The longest first: the edge, then the slices nearest to it.
                if (task == 0)
                    run = workers_.run(edge, worker, edge_, stopPoint);
                else
                    iterateSlice(slices() - task, workers_.factor(worker), stopPoint);
            },
            progress, kStage);
        result_.factorizations += static_cast<int>(1 + slices());
        result_.solves += run.solves;
        for (Index i = 0; i < slices(); ++i)
            result_.solves += iterations(slice(i)) * static_cast<int>(begin(i + 1) - begin(i));
        edge_.sort();
        counts_.push_back({run.sigma, run.below});
        beyond_ = run.coveredTo;
        interior_ = run.below - (edge_.lambdas().array() < run.sigma).count() - c();
        chooseCut();
        selectInterior();
    }

    /// Makes harmonics of the interior, and the basis of all three parts.
    void assemble(const Progress& progress) {
        removeEdge(progress.part(0.0, 0.2));
        quotient_ = rayleighRitz(laplacian_, basis_.Phi.middleCols(c(), interior_),
                                 progress.part(0.2, 0.9));
        const Index first = c() + interior_, rest = size_ - first;
        if (basis_.Phi.cols() != size_) basis_.Phi.conservativeResize(Eigen::NoChange, size_);
        basis_.Phi.rightCols(rest) = edge_.vectors(0, rest);
        basis_.lambda.resize(size_);
        basis_.lambda << Eigen::VectorXd::Zero(c()), quotient_, edge_.lambdas().head(rest);
        mergeEdge(first);
        certifyBasis(laplacian_, c(), cut_, workers_.factor(0), basis_, progress.part(0.9, 1.0));
        ++result_.factorizations;
    }

    /// Whether residuals and leaks are within the gate.
    bool passes(const UpdateGate& gate) const {
        const auto lambda = basis_.lambda.array();
        const auto residual = basis_.residuals.array() * lambda;
        return basis_.residuals.maxCoeff() <= gate.largestResidual &&
               basis_.residuals.mean() <= gate.meanResidual &&
               (residual / (beyond_ - lambda)).maxCoeff() <= gate.largestLeak;
    }

    /// Whether the counts are those of the basis.
    bool isComplete() const {
        return basis_.inertiaCount == size_ && agree(basis_.lambda, size_, counts_);
    }

  private:
    Index c() const { return constants_.count(); }
    Index wanted() const { return k_ - c(); }

    /// The run that finds the edge: from some pairs below the wanted number to some above the
    /// number that the previous basis had, which did not cut a cluster.
    SliceTask edgeTask(const Eigen::MatrixXd& none) const {
        const Index end = wanted() - kEdgeBelow, last = quotient_.size() - 1;
        const double spacing = sortedQuotient(wanted() - 1) / static_cast<double>(k_);
        const double from = 0.5 * (sortedQuotient(end - 1) + sortedQuotient(end));
        const double to = sortedQuotient(last) + static_cast<double>(kEdgeAbove) * spacing;
        return {0.5 * (from + to), from, to, kOverlap * spacing, none, {}, 0, 1};
    }

    void iterateSlice(Index i, ShiftedLdlt& factor, const StopPoint& stopPoint) {
        const Index first = begin(i), count = begin(i + 1) - first;
        Eigen::MatrixXd S(laplacian_.D.size(), count);
        for (Index j = 0; j < count; ++j) S.col(j) = candidate(sorted(first + j));
        factor.factorize(laplacian_, slice(i).middle());
        counts_[static_cast<std::size_t>(i)] = {factor.shift(), factor.eigenvaluesBelow()};
        iterate(laplacian_, constants_, factor, slice(i), S, stopPoint);
        for (Index j = 0; j < count; ++j) candidate(sorted(first + j)) = S.col(j);
    }

    /// The cut is in the edge: its eigenvalues are as good as those of a basis from nothing. The
    /// next one beyond it may be anywhere behind its end.
    void chooseCut() {
        const Index first = c() + interior_, known = first + edge_.size();
        Eigen::VectorXd lambda(known + 1);
        lambda << Eigen::VectorXd::Zero(first), edge_.lambdas(), beyond_;
        const std::optional<Index> size =
            first < k_ && k_ <= known ? cutOutsideClusters(lambda, k_) : std::nullopt;
        if (!size) throw SolverFailure("the cut is not within the edge");
        size_ = *size;
        cut_ = 0.5 * (lambda[size_ - 1] + lambda[size_]);
    }

    /// Brings the interior to the first columns: of the last slice, in whose place the edge begins,
    /// those candidates are taken that are most independent of the edge and of each other.
    void selectInterior() {
        const Index first = begin(slices() - 1), needed = interior_ - first;
        Eigen::MatrixXd S(laplacian_.D.size(), iterated_ - first);
        if (needed <= 0 || needed > S.cols())
            throw SolverFailure("harmonics have moved across the edge");
        for (Index j = 0; j < S.cols(); ++j) S.col(j) = candidate(sorted(first + j));
        const Eigen::ArrayXd squared = (S.cwiseAbs2().transpose() * laplacian_.D).array();
        S.array().rowwise() /= squared.sqrt().transpose();
        removeEdge(S);
        // With pivots: at each place what the columns before it leave of the longest one.
        const Eigen::LDLT<Eigen::MatrixXd> ldlt(innerProducts(S, laplacian_.D, S));
        if (!(ldlt.vectorD()[needed - 1] > kDependent))
            throw SolverFailure("the vectors of a slice have become dependent");
        Eigen::VectorXi ranks(S.cols());
        std::iota(ranks.begin(), ranks.end(), static_cast<int>(first));
        ranks = ldlt.transpositionsP() * ranks;

        std::vector<Index> taken(order_.begin(), order_.begin() + first);
        for (Index i = 0; i < needed; ++i) taken.push_back(sorted(ranks[i]));
        std::sort(taken.begin(), taken.end());
        for (Index j = 0; j < interior_; ++j)
            candidate(j) = candidate(taken[static_cast<std::size_t>(j)]).eval();
    }

    /// Brings the pairs from `first` on, those of the edge, to their places: where the run has
    /// overlooked a copy of a multiple eigenvalue it is in the interior, above the edge's lowest.
    void mergeEdge(Index first) {
        for (Index i = first; i < size_; ++i)
            for (Index j = i; j > c() && basis_.lambda[j] < basis_.lambda[j - 1]; --j) {
                std::swap(basis_.lambda[j], basis_.lambda[j - 1]);
                basis_.Phi.col(j).swap(basis_.Phi.col(j - 1));
            }
    }

    /// Takes the edge out of the interior.
    void removeEdge(const Progress& progress) {
        runInParallel((interior_ + kColumns - 1) / kColumns,
                      [&](Index task, int, const StopPoint&) {
                          const Index first = task * kColumns;
                          removeEdge(basis_.Phi.middleCols(c() + first,
                                                           std::min(kColumns, interior_ - first)));
                      },
                      progress, kStage);
    }

    void removeEdge(Eigen::Ref<Eigen::MatrixXd> S) {
        const auto E = edge_.vectors(0, edge_.size());
        subtractProduct(E, innerProducts(E, laplacian_.D, S), S);
    }

    // Slices of equal width.
    Index slices() const { return std::max<Index>(1, (iterated_ + kSliceWidth / 2) / kSliceWidth); }
    Index begin(Index slice) const { return slice * iterated_ / slices(); }
    Slice slice(Index i) const {
        return {sortedQuotient(begin(i)), sortedQuotient(begin(i + 1) - 1), beyond_};
    }

    Index sorted(Index i) const { return order_[static_cast<std::size_t>(i)]; }
    double sortedQuotient(Index i) const { return quotient_[sorted(i)]; }
    Eigen::MatrixXd::ColXpr candidate(Index j) { return basis_.Phi.col(c() + j); }

    const Laplacian& laplacian_;
    const ConstantModes& constants_;
    Index k_;
    HarmonicBasis& basis_;
    BasisUpdateResult& result_;
    SliceWorkers workers_;

    Eigen::VectorXd quotient_;  // of the candidates
    std::vector<Index> order_;  // of the candidates, by their quotients
    Index iterated_ = 0;        // candidates that are iterated: the first in this order
    PairStore edge_;
    double beyond_ = 0.0;  // end of the edge: what follows is in none of the three parts
    Index interior_ = 0;   // harmonics
    Index size_ = 0;       // of the basis
    double cut_ = 0.0;     // shift between the last harmonic of the basis and the next
    std::vector<Count> counts_;
};

}  // namespace

BasisUpdateResult updateBasis(const Laplacian& laplacian, const ConstantModes& constants, Index k,
                              const UpdateGate& gate, HarmonicBasis& basis,
                              const Progress& progress) {
    BasisUpdateResult result;
    const bool isSmall = k - constants.count() < kFewest || isDenseQuicker(laplacian.D.size());
    if (isSmall || basis.size() < k) return result;
    try {
        Update update(laplacian, constants, k, basis, result);
        if (!(update.sortCandidates(progress.part(0.0, 0.1)) <= gate.largestChange)) return result;
        update.compute(progress.part(0.1, 0.6));
        update.assemble(progress.part(0.6, 1.0));
        result.accepted = update.passes(gate) && update.isComplete();
    } catch (const SolverFailure&) {
        // The step was so large that the old vectors are no start: the caller computes anew.
    }
    return result;
}

}  // namespace spectral
