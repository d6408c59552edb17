#include "basis_update.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <numeric>
#include <vector>

#include "basis_certificate.h"
#include "dense_products.h"
#include "errors.h"
#include "parallel_tasks.h"
#include "rayleigh_ritz.h"
#include "shifted_ldlt.h"

namespace spectral {

namespace {

/// Vectors of a slice, about: they share a factorization, which costs as much as 50 solves.
constexpr Index kSliceWidth = 44;

/// Inverse iterations before the Rayleigh-Ritz procedure, whose cost is several times theirs.
/// The last slice takes more: it is the one beside which nothing of the spectrum is at hand.
constexpr int kIterations = 2, kLastIterations = 4;

/// An update is a round of iterations and Rayleigh-Ritz, and a second one where the first misses
/// the gate by no more than this factor. More would cost as much as a basis from nothing.
constexpr int kMaxRounds = 2;
constexpr double kHopeless = 20.0;

/// Relative error of an eigenvalue that the count by inertia forgives beside a shift.
constexpr double kCountTolerance = 1e-4;

constexpr const char* kStage = "updating the harmonics";

/// Where the inertia of a factorization has counted the eigenvalues.
struct Count {
    double sigma = 0.0;
    Index below = 0;
};

Count countBelow(const Laplacian& laplacian, double sigma) {
    ShiftedLdlt ldlt;
    ldlt.factorize(laplacian, sigma);
    return {ldlt.shift(), ldlt.eigenvaluesBelow()};
}

/// D-orthonormalizes the columns of S (n x m) by the Cholesky factor of their Gram matrix.
/// @throws SolverFailure  when they are dependent to working precision.
void orthonormalize(const Eigen::VectorXd& D, Eigen::MatrixXd& S) {
    S.array().rowwise() /= S.colwise().norm().array().eval();
    const Index n = S.rows(), m = S.cols();
    const Eigen::MatrixXd DS = D.asDiagonal() * S;
    Eigen::MatrixXd gram(m, m);
    denseProducts().transposedProduct(S.data(), n, DS.data(), n, gram.data(), m, n, m, m);
    const Eigen::LLT<Eigen::MatrixXd> llt(gram);
    if (llt.info() != Eigen::Success)
        throw SolverFailure("the vectors of a slice have become dependent");
    const Eigen::MatrixXd inverse = llt.matrixU().solve(Eigen::MatrixXd::Identity(m, m));
    Eigen::MatrixXd Q(n, m);
    denseProducts().product(S.data(), n, inverse.data(), m, Q.data(), n, n, m, m);
    S.swap(Q);
}

/// An update at work: the candidates S are the columns of the basis beyond the constant modes.
class Update {
  public:
    Update(const Laplacian& laplacian, const ConstantModes& constants, Index k,
           HarmonicBasis& basis)
        : laplacian_(laplacian),
          constants_(constants),
          basis_(basis),
          size_(basis.Phi.cols() - constants.count()),
          wanted_(k - constants.count()) {}

    /// The order of the candidates by their Rayleigh quotients under the new Laplacian.
    void sort(const Progress& progress) {
        quotient_.resize(size_);
        runInParallel(
            slices(),
            [&](Index slice, int, const StopPoint&) {
                for (Index j = begin(slice); j < begin(slice + 1); ++j) {
                    Eigen::MatrixXd s = candidate(j);
                    constants_.remove(s);
                    const Eigen::VectorXd Ws = laplacian_.W * s.col(0);
                    quotient_[j] = s.col(0).dot(Ws) / s.col(0).cwiseAbs2().dot(laplacian_.D);
                }
            },
            progress, kStage);
        order_.resize(static_cast<std::size_t>(size_));
        std::iota(order_.begin(), order_.end(), Index{0});
        std::stable_sort(order_.begin(), order_.end(),
                         [&](Index a, Index b) { return quotient_[a] < quotient_[b]; });
    }

    /// S <- (W - sigma D)^-1 D S, several times, slice by slice.
    void iterate(const Progress& progress) {
        std::vector<ShiftedLdlt> factors(static_cast<std::size_t>(workerCount()));
        counts_.resize(static_cast<std::size_t>(slices()));
        runInParallel(
            slices(),
            [&](Index task, int worker, const StopPoint& stopPoint) {
                const Index slice = slices() - 1 - task;  // the last one takes longest
                const Index first = begin(slice), count = begin(slice + 1) - first;
                Eigen::MatrixXd S(laplacian_.D.size(), count);
                for (Index j = 0; j < count; ++j) S.col(j) = candidate(sorted(first + j));
                ShiftedLdlt& factor = factors[static_cast<std::size_t>(worker)];
                // In the middle of what is wanted: of the last slice, not of the guards.
                const Index last = std::min(first + count, wanted_) - 1;
                factor.factorize(laplacian_,
                                 0.5 * (quotient_[sorted(first)] + quotient_[sorted(last)]));
                counts_[static_cast<std::size_t>(slice)] = {factor.shift(),
                                                            factor.eigenvaluesBelow()};
                constants_.remove(S);
                for (int i = 0; i < iterations(slice); ++i) {
                    // Else all columns would come near the eigenvectors next to the shift.
                    if (i > 0) orthonormalize(laplacian_.D, S);
                    stopPoint();
                    S = factor.solve(laplacian_.D.asDiagonal() * S);
                }
                constants_.remove(S);
                S.array().rowwise() /= S.colwise().norm().array().eval();
                for (Index j = 0; j < count; ++j) candidate(sorted(first + j)) = S.col(j);
            },
            progress, kStage);
    }

    /// Makes Ritz vectors of the candidates, all of them together.
    void rayleighRitz(const Progress& progress) {
        quotient_ = spectral::rayleighRitz(laplacian_, basis_.Phi.rightCols(size_), progress);
        std::iota(order_.begin(), order_.end(), Index{0});
    }

    /// The Ritz values; 0 for the constant modes.
    Eigen::VectorXd lambda() const {
        Eigen::VectorXd all = Eigen::VectorXd::Zero(basis_.Phi.cols());
        all.tail(size_) = quotient_;
        return all;
    }

    const std::vector<Count>& counts() const { return counts_; }

    /// Solves of one round.
    int solves() const {
        int sum = 0;
        for (Index i = 0; i < slices(); ++i)
            sum += iterations(i) * static_cast<int>(begin(i + 1) - begin(i));
        return sum;
    }

  private:
    // Slices of equal width of what is wanted; the guards are in the last one.
    Index slices() const { return std::max<Index>(1, (wanted_ + kSliceWidth / 2) / kSliceWidth); }
    Index begin(Index slice) const { return slice < slices() ? slice * wanted_ / slices() : size_; }
    int iterations(Index slice) const {
        return slice + 1 < slices() ? kIterations : kLastIterations;
    }
    Index sorted(Index i) const { return order_[static_cast<std::size_t>(i)]; }
    Eigen::MatrixXd::ColXpr candidate(Index j) { return basis_.Phi.col(constants_.count() + j); }

    const Laplacian& laplacian_;
    const ConstantModes& constants_;
    HarmonicBasis& basis_;
    Index size_, wanted_;
    Eigen::VectorXd quotient_;
    std::vector<Index> order_;
    std::vector<Count> counts_;
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

/// How far the basis is from what the gate asks: at most 1 when it passes.
double excess(const UpdateGate& gate, const HarmonicBasis& basis) {
    return std::max(basis.residuals.maxCoeff() / gate.largestResidual,
                    basis.residuals.mean() / gate.meanResidual);
}

}  // namespace

BasisUpdateResult updateBasis(const Laplacian& laplacian, const ConstantModes& constants, Index k,
                              const UpdateGate& gate, HarmonicBasis& basis,
                              const Progress& progress) {
    BasisUpdateResult result;
    const Index c = constants.count(), columns = basis.Phi.cols();
    if (columns <= k || k <= c || basis.guards() == 0) return result;
    basis.Phi.leftCols(c) = constants.orthonormal();
    try {
        Update update(laplacian, constants, k, basis);
        update.sort(progress.part(0.0, 0.1));
        for (int round = 0; round < kMaxRounds && !result.accepted; ++round) {
            const Progress stage = progress.part(round == 0 ? 0.1 : 0.6, round == 0 ? 0.6 : 1.0);
            update.iterate(stage.part(0.0, 0.4));
            update.rayleighRitz(stage.part(0.4, 0.9));
            result.factorizations += static_cast<int>(update.counts().size()) + 1;
            result.solves += update.solves();

            const Eigen::VectorXd lambda = update.lambda();
            const std::optional<Index> size = cutOutsideClusters(lambda, k);
            if (!size) return result;
            basis.lambda = lambda.head(*size);
            measureBasis(laplacian, c, basis, stage.part(0.9, 1.0));
            std::vector<Count> counts = update.counts();
            counts.push_back(countBelow(laplacian, 0.5 * (lambda[*size - 1] + lambda[*size])));
            basis.inertiaCount = counts.back().below;
            const double beyond = excess(gate, basis);
            result.accepted =
                beyond <= 1.0 && basis.inertiaCount == *size && agree(lambda, *size, counts);
            if (beyond > kHopeless) return result;
        }
    } catch (const SolverFailure&) {
        // The step was so large that the old vectors are no start: the caller computes anew.
    }
    return result;
}

}  // namespace spectral
