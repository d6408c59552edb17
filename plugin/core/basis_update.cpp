#include "basis_update.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "basis_certificate.h"
#include "errors.h"
#include "leak_correction.h"
#include "mass_products.h"
#include "parallel_tasks.h"
#include "rayleigh_ritz.h"
#include "slice_iteration.h"
#include "slice_layout.h"
#include "slice_runs.h"
#include "spectrum_edge.h"
#include "update_candidates.h"

namespace spectral {

namespace {

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

/// Columns that a task takes: few beside the basis, enough for products at full speed.
constexpr Index kColumns = 48;

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
           const CandidateSpectrum& spectrum, HarmonicBasis& basis,
           std::vector<ShiftedLdlt>& factors, BasisUpdateResult& result)
        : laplacian_(laplacian),
          constants_(constants),
          k_(k),
          basis_(basis),
          result_(result),
          workers_(laplacian, constants, factors),
          edge_(laplacian, constants, k, spectrum.quotient, workers_),
          slices_(layOutSlices(spectrum.quotient, edge_.end(), kDamping * spectrum.change)),
          counts_(slices_.size()) {}

    /// Computes the edge and, beside it, iterates the interior.
    void compute(const Progress& progress) {
        const auto slices = static_cast<Index>(slices_.size());
        runInParallel(
            slices + 2,
            [&](Index task, int worker, const StopPoint& stopPoint) {
                if (task == 0)
                    edge_.run(worker, stopPoint);
                else if (task <= slices)
                    iterateSlice(static_cast<std::size_t>(task - 1), workers_.factor(worker),
                                 stopPoint);
                else
                    edge_.countAtEnd(worker);
            },
            progress.part(0.0, 0.8), kUpdateStage);
        edge_.complete(progress.part(0.8, 1.0));
        workers_.releaseMemory();
        result_.factorizations += static_cast<int>(slices) + edge_.factorizations();
        result_.solves += edge_.solves();
        for (const SliceOfVectors& vectors : slices_)
            result_.solves += iterations(vectors.slice) * static_cast<int>(vectors.count);
        counts_.push_back({edge_.shift(), edge_.eigenvaluesBelowShift()});
        interior_ = edge_.eigenvaluesBefore() - c();
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
        const Eigen::VectorXd ritzValues =
            rayleighRitz(laplacian_, candidates(0, independent_), factor.order(laplacian_),
                         interior, progress.part(0.2, 0.9));
        const Index first = c() + interior_, rest = size_ - first;
        if (basis_.Phi.cols() != size_) basis_.Phi.conservativeResize(Eigen::NoChange, size_);
        basis_.Phi.leftCols(c()) = constants_.orthonormal();
        basis_.Phi.rightCols(rest) = edge_.pairs().vectors(0, rest);
        basis_.lambda.resize(size_);
        basis_.lambda << Eigen::VectorXd::Zero(c()), ritzValues, edge_.pairs().lambdas().head(rest);
        mergeEdge(first);
        basis_.leak = {ritzValues[interior_ - 1], edge_.end()};
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
        const Eigen::ArrayXd leak = residual * lambda / (edge_.end() - lambda);
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
    Index all() const { return basis_.Phi.cols() - c(); }  // candidates

    void iterateSlice(std::size_t i, ShiftedLdlt& factor, const StopPoint& stopPoint) {
        const SliceOfVectors& vectors = slices_[i];
        factor.factorize(laplacian_, vectors.slice.middle());
        counts_[i] = {factor.shift(), factor.eigenvaluesBelow()};
        iterate(laplacian_, constants_, factor, vectors.slice,
                candidates(vectors.first, vectors.count), stopPoint);
    }

    /// The cut is in the edge: its eigenvalues are as good as those of a basis from nothing. The
    /// next one beyond it may be anywhere behind its end.
    void chooseCut() {
        const Index first = c() + interior_, known = first + edge_.pairs().size();
        Eigen::VectorXd lambda(known + 1);
        lambda << Eigen::VectorXd::Zero(first), edge_.pairs().lambdas(), edge_.end();
        const std::optional<Index> size =
            first < k_ && k_ <= known ? cutOutsideClusters(lambda, k_) : std::nullopt;
        if (!size) throw SolverFailure("the cut is not within the edge");
        size_ = *size;
        cut_ = 0.5 * (lambda[size_ - 1] + lambda[size_]);
    }

    /// Takes the edge out of the candidates. Returns the squared lengths of what it had of each.
    Eigen::VectorXd removeEdge(const Progress& progress) {
        Eigen::VectorXd removed(all());
        runInParallel((all() + kColumns - 1) / kColumns,
                      [&](Index task, int, const StopPoint&) {
                          const Index first = task * kColumns;
                          const Index count = std::min(kColumns, all() - first);
                          const auto E = edge_.pairs().vectors(0, edge_.pairs().size());
                          const Eigen::MatrixXd C =
                              innerProducts(candidates(first, count), laplacian_.D, E).transpose();
                          subtractProduct(E, C, candidates(first, count));
                          removed.segment(first, count) = C.colwise().squaredNorm();
                      },
                      progress, kUpdateStage);
        return removed;
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
    SpectrumEdge edge_;
    std::vector<SliceOfVectors> slices_;
    std::vector<Count> counts_;  // at the slices' shifts and the edge's
    Index interior_ = 0;         // harmonics
    Index independent_ = 0;      // candidates that they are made of
    Index size_ = 0;             // of the basis
    double cut_ = 0.0;           // shift between the last harmonic of the basis and the next
};

}  // namespace

BasisUpdateResult updateBasis(const Laplacian& laplacian, const ConstantModes& constants, Index k,
                              const UpdateGate& gate, HarmonicBasis& basis,
                              std::vector<ShiftedLdlt>& factors, const Progress& progress) {
    BasisUpdateResult result;
    const Index c = constants.count();
    if (k - c < kFewest || isDenseQuicker(laplacian.D.size()) || basis.size() < k) return result;
    try {
        const CandidateSpectrum spectrum =
            examineCandidates(laplacian, constants, k - c, basis.Phi.rightCols(basis.size() - c),
                              progress.part(0.0, 0.1));
        if (!(spectrum.change <= gate.largestChange)) return result;
        Update update(laplacian, constants, k, spectrum, basis, factors, result);
        update.compute(progress.part(0.1, 0.6));
        update.assemble(progress.part(0.6, 1.0));
        result.accepted = update.passes(gate) && update.isComplete();
    } catch (const SolverFailure&) {
        // The step was so large that the old vectors are no start: the caller computes anew.
    }
    return result;
}

}  // namespace spectral
