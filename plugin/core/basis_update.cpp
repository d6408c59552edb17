#include "basis_update.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "basis_certificate.h"
#include "errors.h"
#include "leak_correction.h"
#include "mass_products.h"
#include "pair_store.h"
#include "parallel_tasks.h"
#include "rayleigh_ritz.h"
#include "slice_iteration.h"
#include "slice_runs.h"
#include "symmetric_product.h"

namespace spectral {

namespace {

/// What a slice costs beside a solve for one vector: its factorization; and to make one of its
/// vectors orthogonal to the others, divided by their number.
constexpr double kFactorization = 65.0, kOrthogonalization = 1.0 / 60.0;

/// Candidates from one possible end of a slice to the next.
constexpr Index kGrain = 4;

/// Harmonics next to the cut that are computed anew, below and above it.
constexpr Index kEdgeBelow = 10, kEdgeAbove = 8;

/// How far beyond these the pairs of the run have to converge, in mean distances of eigenvalues;
/// their residuals, within the edge and there; and the Krylov dimension at which that is first
/// looked at.
constexpr double kOverlap = 1.0, kEdgeResidual = 3e-5, kResidualBeyond = 1e-3;
constexpr Index kEdgeCheck = 44;

/// Damping of the interior, as a multiple of the mean residual of the previous harmonics: what is
/// left of it leaks.
constexpr double kDamping = 120.0;

/// Fewer harmonics than this are computed from nothing as quickly.
constexpr Index kFewest = 64;

/// Candidates next to the cut that may be left with little of their own when the edge has been
/// taken out of them; how many more of them are kept than there are harmonics; and the length that
/// others leave of a unit vector, below which it is none of its own.
constexpr Index kNextToEdge = 32, kSpare = 4;
constexpr double kDependent = 3e-5;

/// Relative error of an eigenvalue that the count by inertia forgives beside a shift.
constexpr double kCountTolerance = 1e-4;

/// Columns that a task takes: few beside the basis, enough for products at full speed; and those
/// that it looks at, for which it needs copies.
constexpr Index kColumns = 48, kColumnsExamined = 8;

/// Candidates below the cut that are all looked at before they are touched; of the others one in so
/// many is.
constexpr Index kExamined = 48, kSampling = 8;

constexpr const char* kStage = "updating the harmonics";

Index at(const std::vector<Index>& indices, Index i) {
    return indices[static_cast<std::size_t>(i)];
}

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
           HarmonicBasis& basis, std::vector<ShiftedLdlt>& factors, BasisUpdateResult& result)
        : laplacian_(laplacian),
          constants_(constants),
          k_(k),
          basis_(basis),
          result_(result),
          workers_(laplacian, constants, factors),
          // More would mean that the spectrum has changed too much.
          edge_(laplacian.D.size(), 2 * (basis.size() - k + kEdgeBelow + kEdgeAbove)) {
        basis_.Phi.leftCols(c()) = constants_.orthonormal();
    }

    /// Looks at candidates under the new Laplacian: at some, and next to the cut at all, which it
    /// puts in the order of their Rayleigh quotients. Returns their mean residual.
    double examineCandidates(const Progress& progress) {
        const Index all = basis_.Phi.cols() - c(), tail = std::max(Index{0}, wanted() - kExamined);
        std::vector<Index> examined;
        for (Index i = 0; i < tail; i += kSampling) examined.push_back(i);
        const auto sampled = static_cast<Index>(examined.size());
        for (Index i = tail; i < all; ++i) examined.push_back(i);
        const auto count = static_cast<Index>(examined.size());
        Eigen::VectorXd quotient(count), residual(count);
        runInParallel((count + kColumnsExamined - 1) / kColumnsExamined,
                      [&](Index task, int, const StopPoint&) {
                          const Index first = task * kColumnsExamined;
                          const Index columns = std::min(kColumnsExamined, count - first);
                          Eigen::MatrixXd S(laplacian_.D.size(), columns);
                          for (Index j = 0; j < columns; ++j)
                              S.col(j) = candidate(at(examined, first + j));
                          examine(S, quotient.segment(first, columns),
                                  residual.segment(first, columns));
                      },
                      progress, kStage);
        quotient_.resize(all);
        sortTail(tail, quotient.tail(count - sampled));
        // Of the others, about: in between those of the sample, which are nearly in order.
        for (Index i = 0; i < tail; ++i) {
            const Index place = i / kSampling;
            const double next = place + 1 < sampled ? quotient[place + 1] : quotient_[tail];
            const double part = static_cast<double>(i % kSampling) / kSampling;
            quotient_[i] = (1.0 - part) * quotient[place] + part * next;
        }
        std::sort(quotient_.begin(), quotient_.end());
        change_ = residual.mean();
        return change_;
    }

    /// Rayleigh quotients and residuals, as UpdateGate has them, of the columns of S, which loses
    /// its constants.
    void examine(Eigen::MatrixXd& S, Eigen::Ref<Eigen::VectorXd> quotient,
                 Eigen::Ref<Eigen::VectorXd> residual) const {
        const Eigen::ArrayXd D = laplacian_.D.array(), invD = D.inverse();
        constants_.remove(S);
        const Eigen::MatrixXd WS = symmetricProduct(laplacian_.W, S);
        for (Index j = 0; j < S.cols(); ++j) {
            const auto phi = S.col(j).array();
            const auto Wphi = WS.col(j).array();
            const double squared = (D * phi.square()).sum();
            const double q = (phi * Wphi).sum() / squared;
            quotient[j] = q;
            residual[j] =
                std::sqrt((invD * (Wphi - q * D * phi).square()).sum() / (q * q * squared));
        }
    }

    /// Puts the candidates from `first` on in the order of their quotients.
    void sortTail(Index first, const Eigen::VectorXd& quotient) {
        std::vector<Index> order(static_cast<std::size_t>(quotient.size()));
        std::iota(order.begin(), order.end(), Index{0});
        std::stable_sort(order.begin(), order.end(),
                         [&](Index a, Index b) { return quotient[a] < quotient[b]; });
        for (Index j = 0; j < quotient.size(); ++j) {
            quotient_[first + j] = quotient[at(order, j)];
            // What was here has gone to where its place was taken from.
            Index from = at(order, j);
            while (from < j) from = at(order, from);
            if (from != j) candidate(first + j).swap(candidate(first + from));
        }
    }

    /// Computes the edge and, beside it, iterates the interior.
    void compute(const Progress& progress) {
        const SliceTask edge = edgeTask();
        beyond_ = edge.to;
        layOutSlices();
        counts_.resize(static_cast<std::size_t>(slices()));
        std::vector<Index> longestFirst(counts_.size());
        std::iota(longestFirst.begin(), longestFirst.end(), Index{0});
        std::stable_sort(longestFirst.begin(), longestFirst.end(), [&](Index a, Index b) {
            return cost(begin(a), begin(a + 1)) > cost(begin(b), begin(b + 1));
        });
        SliceRun run;
        Index belowEnd = 0;  // of the edge
        runInParallel(
            slices() + 2,
            [&](Index task, int worker, const StopPoint& stopPoint) {
                if (task == 0) {
                    run = workers_.run(edge, worker, edge_, stopPoint);
                } else if (task <= slices()) {
                    iterateSlice(at(longestFirst, task - 1), workers_.factor(worker), stopPoint);
                } else {
                    workers_.factor(worker).factorize(laplacian_, edge.to);
                    belowEnd = workers_.factor(worker).eigenvaluesBelow();
                }
            },
            progress.part(0.0, 0.8), kStage);
        result_.factorizations += static_cast<int>(2 + slices());
        result_.solves += run.solves;
        for (Index i = 0; i < slices(); ++i)
            result_.solves += iterations(slice(i)) * static_cast<int>(begin(i + 1) - begin(i));
        findOverlooked(edge, run, belowEnd, progress.part(0.8, 1.0));
        workers_.releaseMemory();
        edge_.sort();
        counts_.push_back({run.sigma, run.below});
        interior_ = run.below - (edge_.lambdas().array() < run.sigma).count() - c();
        chooseCut();
    }

    /// Makes harmonics of the interior, and the basis of all three parts.
    void assemble(const Progress& progress) {
        leaveOutDependent(removeEdge(progress.part(0.0, 0.2)));
        ShiftedLdlt& factor = workers_.factor(0);
        const auto interior = [&] {
            factor.factorize(laplacian_, cut_);
            basis_.inertiaCount = factor.eigenvaluesBelow();
            return interior_;
        };
        quotient_ = rayleighRitz(laplacian_, candidates(0, independent_), interior,
                                 progress.part(0.2, 0.9));
        const Index first = c() + interior_, rest = size_ - first;
        if (basis_.Phi.cols() != size_) basis_.Phi.conservativeResize(Eigen::NoChange, size_);
        basis_.Phi.rightCols(rest) = edge_.vectors(0, rest);
        basis_.lambda.resize(size_);
        basis_.lambda << Eigen::VectorXd::Zero(c()), quotient_, edge_.lambdas().head(rest);
        mergeEdge(first);
        basis_.leak = {quotient_[interior_ - 1], beyond_};
        measureBasis(
            laplacian_, c(), basis_, [&] { factor.factorize(laplacian_, correctionShift(basis_)); },
            progress.part(0.9, 1.0));
        result_.factorizations += 2;
    }

    /// Whether leaks and errors are within the gate.
    bool passes(const UpdateGate& gate) const {
        const Index pairs = basis_.size() - c();
        const auto lambda = basis_.lambda.tail(pairs).array();
        const auto residual = basis_.residuals.tail(pairs).array();
        const Eigen::ArrayXd leak = residual * lambda / (beyond_ - lambda);
        return leak.maxCoeff() <= gate.largestLeak &&
               (leak * residual).maxCoeff() <= gate.largestError;
    }

    /// Whether the counts are those of the basis.
    bool isComplete() const {
        return basis_.inertiaCount == size_ && basis_.lambda[size_ - 1] < cut_ &&
               agree(basis_.lambda, size_, counts_);
    }

  private:
    Index c() const { return constants_.count(); }
    Index wanted() const { return k_ - c(); }
    Index all() const { return quotient_.size(); }  // candidates

    /// The run that finds the edge: from some pairs below the wanted number to some above the
    /// number that the previous basis had, which did not cut a cluster.
    SliceTask edgeTask() const {
        const Index end = wanted() - kEdgeBelow, last = quotient_.size() - 1;
        const double spacing = quotient_[wanted() - 1] / static_cast<double>(k_);
        SliceTask task;
        task.from = 0.5 * (quotient_[end - 1] + quotient_[end]);
        task.to = quotient_[last] + static_cast<double>(kEdgeAbove) * spacing;
        task.sigma = 0.5 * (task.from + task.to);
        task.overlap = kOverlap * spacing;
        task.seed = 1;
        task.residual = kEdgeResidual;
        task.residualBeyond = kResidualBeyond;
        task.firstCheck = kEdgeCheck;
        return task;
    }

    void iterateSlice(Index i, ShiftedLdlt& factor, const StopPoint& stopPoint) {
        const Index first = begin(i), count = begin(i + 1) - first;
        factor.factorize(laplacian_, slice(i).middle());
        counts_[static_cast<std::size_t>(i)] = {factor.shift(), factor.eigenvaluesBelow()};
        iterate(laplacian_, constants_, factor, slice(i), candidates(first, count), stopPoint);
    }

    /// Where the run has overlooked copies of multiple eigenvalues above its shift, computes the
    /// edge once more: accurately, so that another run can leave out what is known, and find them.
    /// Below the shift the interior has such copies.
    void findOverlooked(SliceTask edge, const SliceRun& run, Index belowEnd,
                        const Progress& progress) {
        const auto missing = [&] {
            return belowEnd - run.below - (edge_.lambdas().array() >= run.sigma).count();
        };
        if (missing() > 0) {
            edge_.clear();
            edge.residual = edge.residualBeyond = SliceTask().residual;
            runAlone(edge, progress.part(0.0, 0.5));
        }
        if (missing() > 0) {
            SliceTask copies;
            copies.from = run.sigma;
            copies.to = edge.to;
            copies.sigma = 0.5 * (copies.from + copies.to);
            copies.known = edge_.size();
            copies.missing = missing();
            copies.seed = edge.seed + 1;
            runAlone(copies, progress.part(0.5, 1.0));
        }
        if (missing() != 0)
            throw SolverFailure("the edge has not as many pairs as the inertia counts");
    }

    void runAlone(const SliceTask& task, const Progress& progress) {
        result_.solves += workers_.execute({task}, edge_, progress).front().solves;
        ++result_.factorizations;
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

    /// Of the candidates in whose place the edge begins, leaves out those that it and the others
    /// make up; the rest come first. There may be some more of them than harmonics: which of their
    /// combinations these are, the Rayleigh-Ritz procedure finds.
    /// @param removed  squared lengths of what the edge has had of each.
    void leaveOutDependent(const Eigen::VectorXd& removed) {
        const Index first = std::max(Index{0}, all() - kNextToEdge);
        Eigen::MatrixXd G = gramMatrix(candidates(first, all() - first), laplacian_.D);
        const Eigen::VectorXd lengths = (G.diagonal() + removed.tail(G.rows())).cwiseSqrt();
        G = lengths.cwiseInverse().asDiagonal() * G * lengths.cwiseInverse().asDiagonal();
        // A^T A is their Gram matrix, so that A has their lengths and angles, as parts of unit
        // vectors. The QR decomposition takes next the one of which those before leave most.
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> gram(G);
        const Eigen::MatrixXd A = gram.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
                                  gram.eigenvectors().transpose();
        const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(A);
        const Index independent = (qr.matrixQR().diagonal().array().abs() > kDependent).count();
        const Index needed = interior_ - first, count = std::min(independent, needed + kSpare);
        if (needed <= 0 || needed > count)
            throw SolverFailure("harmonics have moved across the edge");
        independent_ = first + count;
        Eigen::VectorXi taken = qr.colsPermutation().indices();
        std::sort(taken.begin(), taken.begin() + count);
        for (Index j = 0; j < count; ++j)
            if (taken[j] != j) candidate(first + j) = candidate(first + taken[j]);
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

    /// Takes the edge out of the candidates. Returns the squared lengths of what it had of each.
    Eigen::VectorXd removeEdge(const Progress& progress) {
        Eigen::VectorXd removed(all());
        runInParallel((all() + kColumns - 1) / kColumns,
                      [&](Index task, int, const StopPoint&) {
                          const Index first = task * kColumns;
                          const Index count = std::min(kColumns, all() - first);
                          const auto E = edge_.vectors(0, edge_.size());
                          const Eigen::MatrixXd C =
                              innerProducts(candidates(first, count), laplacian_.D, E).transpose();
                          subtractProduct(E, C, candidates(first, count));
                          removed.segment(first, count) = C.colwise().squaredNorm();
                      },
                      progress, kStage);
        return removed;
    }

    /// Cuts the candidates that are iterated into slices so that all together cost least: those of
    /// a slice share one factorization, but the wider it is the more iterations it takes.
    void layOutSlices() {
        std::vector<Index> ends{0};  // where a slice may end
        while (ends.back() < all()) ends.push_back(std::min(ends.back() + kGrain, all()));
        // The least cost of all slices up to an end, and where the last of them then begins.
        std::vector<double> least(ends.size(), std::numeric_limits<double>::infinity());
        std::vector<std::size_t> last(ends.size(), 0);
        least[0] = 0.0;
        for (std::size_t end = 1; end < ends.size(); ++end)
            for (std::size_t begin = 0; begin < end; ++begin) {
                const double all = least[begin] + cost(ends[begin], ends[end]);
                if (all >= least[end]) continue;
                least[end] = all;
                last[end] = begin;
            }
        begins_ = {all()};
        for (std::size_t end = ends.size() - 1; end > 0; end = last[end])
            begins_.push_back(ends[last[end]]);
        std::reverse(begins_.begin(), begins_.end());
    }

    /// Of a slice, in solves for one vector.
    double cost(Index begin, Index end) const {
        const int solves = iterations(slice(begin, end));
        const auto width = static_cast<double>(end - begin);
        return kFactorization + width * (solves + (solves - 1) * kOrthogonalization * width);
    }

    Index slices() const { return static_cast<Index>(begins_.size()) - 1; }
    Index begin(Index slice) const { return at(begins_, slice); }
    Slice slice(Index i) const { return slice(begin(i), begin(i + 1)); }
    Slice slice(Index begin, Index end) const {
        return {quotient_[begin], quotient_[end - 1], beyond_, kDamping * change_};
    }

    Eigen::MatrixXd::ColXpr candidate(Index i) { return basis_.Phi.col(c() + i); }
    Eigen::MatrixXd::ColsBlockXpr candidates(Index first, Index count) {
        return basis_.Phi.middleCols(c() + first, count);
    }

    const Laplacian& laplacian_;
    const ConstantModes& constants_;
    Index k_;
    HarmonicBasis& basis_;
    BasisUpdateResult& result_;
    SliceWorkers workers_;

    Eigen::VectorXd quotient_;   // of the candidates, about; ascending
    double change_ = 0.0;        // mean residual of the candidates
    std::vector<Index> begins_;  // of the slices, and the end of the last one
    PairStore edge_;
    double beyond_ = 0.0;    // end of the edge: what follows is in none of the three parts
    Index interior_ = 0;     // harmonics
    Index independent_ = 0;  // candidates that they are made of
    Index size_ = 0;         // of the basis
    double cut_ = 0.0;       // shift between the last harmonic of the basis and the next
    std::vector<Count> counts_;
};

}  // namespace

BasisUpdateResult updateBasis(const Laplacian& laplacian, const ConstantModes& constants, Index k,
                              const UpdateGate& gate, HarmonicBasis& basis,
                              std::vector<ShiftedLdlt>& factors, const Progress& progress) {
    BasisUpdateResult result;
    const bool isSmall = k - constants.count() < kFewest || isDenseQuicker(laplacian.D.size());
    if (isSmall || basis.size() < k) return result;
    try {
        Update update(laplacian, constants, k, basis, factors, result);
        if (!(update.examineCandidates(progress.part(0.0, 0.1)) <= gate.largestChange))
            return result;
        update.compute(progress.part(0.1, 0.6));
        update.assemble(progress.part(0.6, 1.0));
        result.accepted = update.passes(gate) && update.isComplete();
    } catch (const SolverFailure&) {
        // The step was so large that the old vectors are no start: the caller computes anew.
    }
    return result;
}

}  // namespace spectral
