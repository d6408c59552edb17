#include "leak_correction.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "basis_transform.h"
#include "mass_products.h"
#include "parallel_tasks.h"
#include "symmetric_product.h"

namespace spectral {

namespace {

/// Relative error of the polynomial, and its terms at most.
constexpr double kAccuracy = 1e-2;
constexpr int kMostTerms = 8;

/// Eigenvalues on either side of the best shift, between two of which it is put.
constexpr Index kNeighbours = 6;

/// Harmonics next to the shift, which a solve magnifies by more than so much beside the rest, are
/// taken out after each: what the rest has let into them would come back to it, too large.
constexpr double kMagnified = 4.0;

constexpr const char* kStage = "filtering";

/// 1 / (mu - lambda_i) = sum_m p(m, i) t^(m + 1) / width, t = width / (mu - sigma), for all mu >=
/// sigma + width.
struct Expansion {
    double sigma = 0.0, width = 0.0;
    Eigen::MatrixXd p;  // terms x k
};

/// For lambda up to the leak's `from` and mu beyond its `into`: there 1 / (mu - lambda) and
/// 1 / (mu - sigma) are in a ratio of 1 at infinity, and of a condition or its inverse at the
/// bound.
Expansion expansionOf(const HarmonicBasis& basis, double sigma) {
    const auto [from, into] = *basis.leak;
    const double width = into - sigma;
    const double condition = std::sqrt(std::max(width / (into - from), into / width));
    const double rate = (condition - 1.0) / (condition + 1.0);  // of Chebyshev's polynomials
    const int terms = std::clamp(
        static_cast<int>(std::ceil(std::log(0.5 * kAccuracy) / std::log(rate))), 1, kMostTerms);
    // Interpolation of 1 / (1 - delta t / width), delta = lambda - sigma, at Chebyshev's points.
    Eigen::MatrixXd powers(terms, terms), values(terms, basis.size());
    for (int j = 0; j < terms; ++j) {
        const double t = 0.5 * (1.0 + std::cos(kPi * (j + 0.5) / terms));
        for (int m = 0; m < terms; ++m) powers(j, m) = std::pow(t, m);
        values.row(j) = (1.0 - (basis.lambda.array() - sigma) * (t / width)).inverse();
    }
    return {sigma, width, powers.partialPivLu().solve(values)};
}

/// The expansion's t as an operator on the rest: width (W - sigma D)^-1 D.
class Resolvent {
  public:
    Resolvent(const HarmonicBasis& basis, const Expansion& expansion, const Eigen::VectorXd& D,
              const ShiftedLdlt& factor)
        : basis_(basis), D_(D), factor_(factor), width_(expansion.width) {
        const double reach = width_ / kMagnified;
        const auto begin = basis.lambda.begin(), end = basis.lambda.end();
        first_ = std::lower_bound(begin, end, expansion.sigma - reach) - begin;
        count_ = std::upper_bound(begin, end, expansion.sigma + reach) - begin - first_;
    }

    /// t U, given D U. Half of the columns are solved for on another core.
    Eigen::MatrixXd applied(const Eigen::MatrixXd& DU, const Progress& progress) const {
        Eigen::MatrixXd U(DU.rows(), DU.cols());
        const Index half = DU.cols() / 2;
        runInParallel(
            2,
            [&](Index task, int, const StopPoint&) {
                const Index first = task * half, count = task == 0 ? half : DU.cols() - half;
                Eigen::MatrixXd columns = width_ * DU.middleCols(first, count);
                factor_.solveInPlace(columns);
                U.middleCols(first, count) = columns;
            },
            progress, kStage);
        const auto magnified = basis_.Phi.middleCols(first_, count_);
        U -= inverseHarmonicTransform(magnified, harmonicTransform(magnified, D_, U));
        return U;
    }

  private:
    const HarmonicBasis& basis_;
    const Eigen::VectorXd& D_;
    const ShiftedLdlt& factor_;
    double width_;
    Index first_ = 0, count_ = 0;  // harmonics next to the shift
};

}  // namespace

double correctionShift(const HarmonicBasis& basis) {
    // Where the condition of the expansion is least: the same at both ends.
    const auto [from, into] = *basis.leak;
    const double best = into - std::sqrt(into * (into - from));
    const Eigen::VectorXd& lambda = basis.lambda;
    const Index last = lambda.size() - 1;
    const Index near = std::clamp<Index>(
        std::lower_bound(lambda.begin(), lambda.end(), best) - lambda.begin(), 1, last);
    Index widest = near;
    for (Index i = std::max<Index>(1, near - kNeighbours); i <= std::min(last, near + kNeighbours);
         ++i)
        if (lambda[i] - lambda[i - 1] > lambda[widest] - lambda[widest - 1]) widest = i;
    return 0.5 * (lambda[widest - 1] + lambda[widest]);
}

Eigen::MatrixXd applyInLeakingBasis(const HarmonicBasis& basis, const Laplacian& laplacian,
                                    const ConstantModes& constants, const Gain& gain,
                                    double residualGain, const Eigen::MatrixXd& X,
                                    const ShiftedLdlt& factor, const Progress& progress) {
    const Index n = X.rows(), c = X.cols(), k = basis.size();
    const Eigen::VectorXd& D = laplacian.D;
    const Eigen::MatrixXd means = constants.means(X);
    Eigen::MatrixXd centred = X;
    constants.add(-means, centred);
    const Eigen::ArrayXd gains = gainsOf(basis, gain) - residualGain;
    const Expansion expansion = expansionOf(basis, factor.shift());
    const Index terms = expansion.p.rows();
    const Eigen::MatrixXd spectrum =
        harmonicTransform(basis.Phi, D, centred, progress.part(0.0, 0.2));

    // Of the basis is needed: its part of X; for each term sum_i c_i phi_i and sum_i lambda_i c_i
    // phi_i, which make sum_i c_i r_i.
    std::vector<Eigen::VectorXd> weights;
    Eigen::MatrixXd C(k, (1 + 2 * terms) * c);
    C.leftCols(c) = spectrum;
    for (Index m = 0; m < terms; ++m) {
        weights.emplace_back(gains * expansion.p.row(m).transpose().array());
        C.middleCols((1 + m) * c, c) = weights.back().asDiagonal() * spectrum;
        C.middleCols((1 + terms + m) * c, c) =
            basis.lambda.asDiagonal() * C.middleCols((1 + m) * c, c);
    }
    const Eigen::MatrixXd B = inverseHarmonicTransform(basis.Phi, C, progress.part(0.2, 0.5));
    const Eigen::MatrixXd R = symmetricProduct(laplacian.W, B.middleCols(c, terms * c)) -
                              D.asDiagonal() * B.rightCols(terms * c);

    // sum_m t^(m + 1) D^-1 R_m by Horner's scheme, in the first columns; and t^(m + 1) of the rest
    // of X, for all m, in the others.
    const Resolvent resolvent(basis, expansion, D, factor);
    Eigen::MatrixXd U(n, 2 * c), powers(n, terms * c);
    U << Eigen::MatrixXd::Zero(n, c), centred - B.leftCols(c);
    const Progress solving = progress.part(0.5, 0.7);
    for (Index m = 0; m < terms; ++m) {
        U = D.asDiagonal() * U;
        U.leftCols(c) += R.middleCols((terms - 1 - m) * c, c);
        U = resolvent.applied(
            U, solving.part(static_cast<double>(m) / static_cast<double>(terms),
                            static_cast<double>(m + 1) / static_cast<double>(terms)));
        powers.middleCols(m * c, c) = U.rightCols(c);
    }
    const auto outside = U.leftCols(c);

    // e_i^T D X by r_i^T U = phi_i^T D (A U - lambda_i U). What the other sum has in the basis
    // goes.
    Eigen::MatrixXd images(n, (2 * terms + 1) * c);
    images << powers, D.cwiseInverse().asDiagonal() * symmetricProduct(laplacian.W, powers),
        outside;
    const Eigen::MatrixXd products =
        harmonicTransform(basis.Phi, D, images, progress.part(0.7, 0.9));
    Eigen::MatrixXd inside = -products.rightCols(c);
    for (Index m = 0; m < terms; ++m)
        inside += weights[static_cast<std::size_t>(m)].asDiagonal() *
                  (products.middleCols((terms + m) * c, c) -
                   basis.lambda.asDiagonal() * products.middleCols(m * c, c));

    const Eigen::MatrixXd kept = gains.matrix().asDiagonal() * spectrum - inside / expansion.width;
    Eigen::MatrixXd Y = residualGain * centred - outside / expansion.width;
    Y += inverseHarmonicTransform(basis.Phi, kept, progress.part(0.9, 1.0));
    constants.remove(Y);
    constants.add(means, Y);
    return Y;
}

}  // namespace spectral
