#include "full_spectrum.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <vector>

#include "errors.h"

namespace spectral {

namespace {

/// Dimensions from one check of the error to the next.
constexpr int kCheckInterval = 3;

/// Below this dimension a difference says nothing: a narrow band has not been seen yet.
constexpr int kFirstCheck = 6;

/// Norm below which a new direction is round-off: the space is invariant, the result exact.
constexpr double kBreakdown = 1e-13;

/// At this multiple of the requested accuracy over the surface the single vertices are looked at
/// too.
constexpr double kNearlyThere = 30.0;

/// Factor on the estimate where it stops short: at a cusp the changes shrink more slowly than any
/// geometric series, and add up to more.
constexpr double kStoppedShort = 3.0;

/// Estimates the error of the newest approximation from the changes between checks, in one norm.
///
/// With changes that shrink by a factor q from check to check, what is still to come is their
/// geometric series, change q / (1 - q). Where convergence is fast the last change itself is taken,
/// which is more; where it is slow the series is, which can be far more than the last change.
class ErrorEstimate {
  public:
    double operator()(double change) {
        changes_.push_back(change);
        constexpr std::size_t kMemory = 4;  // the rate is a mean over so many checks
        const std::size_t span = std::min(kMemory, changes_.size() - 1);
        if (span == 0) return std::numeric_limits<double>::infinity();
        if (change <= 0.0) return 0.0;
        const double ratio = change / changes_[changes_.size() - 1 - span];
        const double q = std::min(std::pow(ratio, 1.0 / static_cast<double>(span)), kSlowest);
        return change * std::max(1.0, q / (1.0 - q));
    }

  private:
    static constexpr double kSlowest = 0.9;  // changes that do not shrink at all are scatter
    std::vector<double> changes_;
};

/// Lanczos recurrence of one column for M = D^1/2 (W + lambda_p D)^-1 D^1/2, the symmetric form of
/// S, with full reorthogonalization. Columns of the basis are D^1/2 times those of U.
class LanczosColumn {
  public:
    explicit LanczosColumn(const Eigen::VectorXd& start)
        : basis_(start.size(), std::min(kCapacity, start.size())), norm_(start.norm()) {
        exhausted_ = !(norm_ > 0.0);
        if (!exhausted_) basis_.col(0) = start / norm_;
    }

    bool exhausted() const { return exhausted_; }
    int dimension() const { return static_cast<int>(alpha_.size()); }
    double norm() const { return norm_; }
    auto current() const { return basis_.col(dimension()); }

    /// Takes w = M current() and makes the next basis vector of it.
    void extend(Eigen::VectorXd w) {
        const Index j = dimension();
        const double scale = w.norm();
        // The three-term recurrence first, so that the pass over the whole basis finds next to
        // nothing and is needed only once: it is memory traffic, the dearest part after the solves.
        alpha_.push_back(basis_.col(j).dot(w));
        w -= alpha_.back() * basis_.col(j);
        if (j > 0) w -= beta_.back() * basis_.col(j - 1);
        const double before = w.norm();
        reorthogonalize(w);
        double beta = w.norm();
        if (beta < 0.5 * before) {  // much was found: what round-off left of it goes now
            reorthogonalize(w);
            beta = w.norm();
        }
        if (!(beta > kBreakdown * scale) || j + 1 == basis_.rows()) {
            exhausted_ = true;
            return;
        }
        beta_.push_back(beta);
        if (j + 1 == basis_.cols())
            basis_.conservativeResize(Eigen::NoChange,
                                      std::min(basis_.rows(), basis_.cols() + kCapacity));
        basis_.col(j + 1) = w / beta;
    }

    /// Coefficients |x| F(sqrt(T^-1 - pole)) e_1 of the present approximation in the basis.
    Eigen::VectorXd coefficients(const Gain& gain, double pole) const {
        const Index m = dimension();
        if (m == 0) return Eigen::VectorXd();
        const Eigen::VectorXd diagonal = Eigen::Map<const Eigen::VectorXd>(alpha_.data(), m);
        const Eigen::VectorXd off = Eigen::Map<const Eigen::VectorXd>(beta_.data(), m - 1);
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> ritz;
        ritz.computeFromTridiagonal(diagonal, off);
        if (ritz.info() != Eigen::Success)
            throw SolverFailure(
                "the tridiagonal eigenproblem of the Krylov space did not converge");
        Eigen::VectorXd gains(m);
        for (Index i = 0; i < m; ++i) {
            // theta = 1/(lambda + pole); round-off may push it out of (0, 1/pole].
            const double theta = ritz.eigenvalues()[i];
            const double lambda = theta > 0.0 ? std::max(0.0, 1.0 / theta - pole)
                                              : std::numeric_limits<double>::infinity();
            gains[i] = gain(std::sqrt(lambda));
        }
        const Eigen::MatrixXd& Q = ritz.eigenvectors();
        return norm_ * (Q * gains.cwiseProduct(Q.row(0).transpose()));
    }

    /// The signal (times D^1/2) with these coefficients in the basis.
    Eigen::VectorXd combine(const Eigen::VectorXd& coefficients) const {
        return basis_.leftCols(coefficients.size()) * coefficients;
    }

  private:
    void reorthogonalize(Eigen::VectorXd& w) const {
        const auto Q = basis_.leftCols(dimension());
        const Eigen::VectorXd overlap = Q.transpose() * w;
        w.noalias() -= Q * overlap;
    }

    static constexpr Index kCapacity = 32;  // columns by which the basis grows

    Eigen::MatrixXd basis_;
    std::vector<double> alpha_, beta_;
    double norm_ = 0.0;
    bool exhausted_ = false;
};

}  // namespace

FullSpectrumResult applyFullSpectrum(const Eigen::VectorXd& D, const ConstantModes& constants,
                                     const ShiftedCholesky& cholesky, const Gain& gain,
                                     const Eigen::MatrixXd& X, const FullSpectrumOptions& options,
                                     const Progress& progress) {
    const Index n = X.rows(), columns = X.cols();
    const double pole = cholesky.shift();
    const Eigen::MatrixXd means = constants.means(X);
    Eigen::MatrixXd centred = X;
    constants.add(-means, centred);
    const Eigen::VectorXd sqrtD = D.cwiseSqrt();
    const double normX = (sqrtD.asDiagonal() * centred).norm();
    const double maxX = centred.cwiseAbs().maxCoeff();

    FullSpectrumResult result;
    if (!(normX > 0.0)) {
        result.Y = X;
        result.converged = true;
        return result;
    }

    std::vector<LanczosColumn> lanczos;
    for (Index c = 0; c < columns; ++c) lanczos.emplace_back(sqrtD.cwiseProduct(centred.col(c)));
    std::vector<Eigen::VectorXd> coefficients(columns);

    // Renews the coefficients of all columns; returns the estimated error of the signals.
    ErrorEstimate overSurface, atVertices;
    double largest = 0.0;
    const auto renew = [&] {
        std::vector<Eigen::VectorXd> change(columns);
        double squares = 0.0;
        for (Index c = 0; c < columns; ++c) {
            const Eigen::VectorXd older = std::move(coefficients[c]);
            coefficients[c] = lanczos[c].coefficients(gain, pole);
            change[c] = coefficients[c];
            change[c].head(older.size()) -= older;
            squares += change[c].squaredNorm();
        }
        const double error = overSurface(std::sqrt(squares) / normX);
        if (error > kNearlyThere * options.accuracy) return error;
        // A norm over the surface hardly sees a vertex of small mass; its error can be larger, and
        // shrink more slowly and less evenly: so the larger one of two changes counts.
        const double before = largest;
        largest = 0.0;
        for (Index c = 0; c < columns; ++c)
            if (change[c].size() > 0)
                largest = std::max(
                    largest,
                    lanczos[c].combine(change[c]).cwiseQuotient(sqrtD).cwiseAbs().maxCoeff());
        return std::max(error, atVertices(std::max(before, largest) / maxX));
    };

    double firstError = 0.0, furthest = 0.0;
    for (int m = 1;; ++m) {
        std::vector<Index> active;
        for (Index c = 0; c < columns; ++c)
            if (!lanczos[c].exhausted()) active.push_back(c);
        if (active.empty()) {  // the Krylov spaces are invariant: no error but round-off
            renew();
            result.errorEstimate = std::numeric_limits<double>::epsilon();
            result.converged = true;
            break;
        }
        Eigen::MatrixXd block(n, static_cast<Index>(active.size()));
        for (std::size_t a = 0; a < active.size(); ++a)
            block.col(a) = sqrtD.cwiseProduct(lanczos[active[a]].current());
        block = cholesky.solve(block);
        // S keeps the complement of the constants; round-off does not, and S amplifies it most
        // there.
        constants.remove(block);
        block = sqrtD.asDiagonal() * block;
        for (std::size_t a = 0; a < active.size(); ++a) lanczos[active[a]].extend(block.col(a));
        result.dimension = m;
        if (m % kCheckInterval != 0) continue;
        result.errorEstimate = renew();
        result.converged = m >= kFirstCheck && result.errorEstimate <= options.accuracy;
        if (result.converged) break;
        if (m >= options.maxDimension) {
            result.errorEstimate *= kStoppedShort;
            break;
        }

        // Convergence is geometric: the logarithm of the error tells how far it is.
        if (!std::isfinite(result.errorEstimate)) continue;
        if (firstError <= 0.0) firstError = std::max(result.errorEstimate, options.accuracy * 10);
        const double done =
            std::log(firstError / result.errorEstimate) / std::log(firstError / options.accuracy);
        furthest = std::clamp(done, furthest, 1.0);  // an estimate may be worse than the one before
        progress.report(furthest, "filtering");
    }

    result.Y.resize(n, columns);
    for (Index c = 0; c < columns; ++c)
        result.Y.col(c) = lanczos[c].combine(coefficients[c]).cwiseQuotient(sqrtD);
    constants.remove(result.Y);
    constants.add(means, result.Y);
    return result;
}

}  // namespace spectral
