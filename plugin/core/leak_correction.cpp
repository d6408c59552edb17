#include "leak_correction.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "basis_transform.h"
#include "mass_products.h"
#include "parallel_tasks.h"

namespace spectral {

namespace {

/// Largest part of a correction that is left, about, and the degree of the polynomial at most.
constexpr double kAccuracy = 1e-2;
constexpr int kMostSolves = 8;

/// Eigenvalues on either side of the best shift, between two of which it is put.
constexpr Index kNeighbours = 6;

/// Harmonics are next to the shift where a solve magnifies them by more than so much, beside what
/// is beyond the bound.
constexpr double kMagnified = 4.0;

constexpr const char* kStage = "filtering";

/// N of t = width / (mu - sigma): least for all mu beyond the bound, where 0 < t < 1, beside its
/// values at the harmonics.
struct NodePolynomial {
    double sigma = 0.0, width = 0.0;
    std::vector<double> roots;  // Chebyshev's points of [0, 1]
    Eigen::VectorXd t;          // of the harmonics, k: outside of [0, 1]

    /// N(t_i), k.
    Eigen::ArrayXd atHarmonics() const {
        Eigen::ArrayXd N = Eigen::ArrayXd::Ones(t.size());
        for (const double root : roots) N *= t.array() - root;
        return N;
    }
};

NodePolynomial nodePolynomial(const HarmonicBasis& basis, double sigma) {
    const auto [from, into] = *basis.leak;
    const double width = into - sigma;
    // 1 / (mu - lambda) and 1 / (mu - sigma) are in a ratio of 1 at infinity, and of a condition or
    // its inverse at the bound.
    const double condition = std::sqrt(std::max(width / (into - from), into / width));
    const double rate = (condition - 1.0) / (condition + 1.0);  // of Chebyshev's polynomials
    const int degree = std::clamp(
        static_cast<int>(std::ceil(std::log(0.5 * kAccuracy) / std::log(rate))), 1, kMostSolves);
    NodePolynomial N{sigma, width, {}, width / (basis.lambda.array() - sigma)};
    for (int j = 0; j < degree; ++j)
        N.roots.push_back(0.5 * (1.0 + std::cos(kPi * (j + 0.5) / degree)));
    return N;
}

/// N(t) U for t = width (W - sigma D)^-1 D, to first order in what harmonics leak.
///
/// What others leak into the harmonics next to the shift is kept apart, else it would come back
/// from there to the others, magnified.
///
/// @param C  Phi^T D U, k x c.
Eigen::MatrixXd applied(const NodePolynomial& N, const HarmonicBasis& basis,
                        const Eigen::VectorXd& D, const ShiftedLdlt& factor, Eigen::MatrixXd U,
                        const Eigen::MatrixXd& C, const StopPoint& stopPoint) {
    const double reach = N.width / kMagnified;
    const auto begin = basis.lambda.begin(), end = basis.lambda.end();
    const Index first = std::lower_bound(begin, end, N.sigma - reach) - begin;
    const Index count = std::upper_bound(begin, end, N.sigma + reach) - begin - first;
    const auto nearest = basis.Phi.middleCols(first, count);
    const auto t = N.t.segment(first, count).array();
    const Eigen::VectorXd scaledD = N.width * D;
    Eigen::MatrixXd own = C.middleRows(first, count),
                    leaked = Eigen::MatrixXd::Zero(count, U.cols());
    for (const double root : N.roots) {
        stopPoint();
        factor.applyResolvent(scaledD, U, root);
        const auto factors = (t - root).matrix().asDiagonal();
        own = factors * own;
        const Eigen::MatrixXd leaking = innerProducts(nearest, D, U) - own;
        subtractProduct(nearest, leaking, U);
        leaked = factors * leaked + leaking;
    }
    subtractProduct(nearest, -leaked, U);
    return U;
}

}  // namespace

double correctionShift(const HarmonicBasis& basis) {
    // Where the condition of the expansion is least: the same at both ends.
    const auto [from, into] = *basis.leak;
    const double best = into - std::sqrt(into * (into - from));
    const Eigen::VectorXd& lambda = basis.lambda;
    const Index last = lambda.size() - 1;
    const Index nearest = std::clamp<Index>(
        std::lower_bound(lambda.begin(), lambda.end(), best) - lambda.begin(), 1, last);
    Index widest = nearest;
    for (Index i = std::max<Index>(1, nearest - kNeighbours);
         i <= std::min(last, nearest + kNeighbours); ++i)
        if (lambda[i] - lambda[i - 1] > lambda[widest] - lambda[widest - 1]) widest = i;
    return 0.5 * (lambda[widest - 1] + lambda[widest]);
}

Eigen::MatrixXd applyInLeakingBasis(const HarmonicBasis& basis, const Eigen::VectorXd& D,
                                    const ConstantModes& constants, const Gain& gain,
                                    double residualGain, const Eigen::MatrixXd& X,
                                    const ShiftedLdlt& factor, const Progress& progress) {
    const Index k = basis.size(), c = X.cols();
    const Eigen::MatrixXd means = constants.means(X);
    Eigen::MatrixXd centred = X;
    constants.add(-means, centred);
    const Eigen::ArrayXd gains = gainsOf(basis, gain) - residualGain;
    const NodePolynomial N = nodePolynomial(basis, factor.shift());
    const Eigen::ArrayXd weights = gains / N.atHarmonics();

    Eigen::MatrixXd C(k, 2 * c);
    C.leftCols(c) = harmonicTransform(basis.Phi, D, centred, progress.part(0.0, 0.2));
    C.rightCols(c) = weights.matrix().asDiagonal() * C.leftCols(c);
    Eigen::MatrixXd U = inverseHarmonicTransform(basis.Phi, C, progress.part(0.2, 0.4));
    U.leftCols(c) = centred - U.leftCols(c);
    const Eigen::MatrixXd spectrum = C.leftCols(c);
    C.leftCols(c).setZero();
    runInParallel(
        2,
        [&](Index half, int, const StopPoint& stopPoint) {
            const auto columns = [&](Eigen::MatrixXd& M) { return M.middleCols(half * c, c); };
            columns(U) = applied(N, basis, D, factor, columns(U), columns(C), stopPoint);
        },
        progress.part(0.4, 0.7), kStage);

    const Eigen::MatrixXd products = harmonicTransform(basis.Phi, D, U, progress.part(0.7, 0.9));
    const Eigen::MatrixXd inside = gains.matrix().asDiagonal() * spectrum +
                                   weights.matrix().asDiagonal() * products.leftCols(c) -
                                   products.rightCols(c);
    Eigen::MatrixXd Y = residualGain * centred + U.rightCols(c);
    Y += inverseHarmonicTransform(basis.Phi, inside, progress.part(0.9, 1.0));
    constants.remove(Y);
    constants.add(means, Y);
    return Y;
}

}  // namespace spectral
