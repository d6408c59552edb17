#include "core/block_lanczos.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace spectral {
namespace {

constexpr Index kVertices = 400;

/// An operator with known eigenpairs: those of a diagonal matrix, seen in D-orthonormal
/// coordinates.
struct Example {
    explicit Example(const Eigen::VectorXd& eigenvalues)
        : theta(eigenvalues),
          D(Eigen::VectorXd::LinSpaced(eigenvalues.size(), 0.2, 3.0)),
          apply([this](const Eigen::MatrixXd& U) {
              return Eigen::MatrixXd(theta.asDiagonal() * U);
          }) {}

    /// Eigenvectors `first` to first + count - 1.
    Eigen::MatrixXd vectors(Index first, Index count) const {
        return Eigen::MatrixXd(D.cwiseSqrt().cwiseInverse().asDiagonal()).middleCols(first, count);
    }

    Eigen::VectorXd theta, D;
    BlockLanczos::Operator apply;
};

/// 1 / (i - sigma): a spectrum of equal distances, inverted about a shift.
Eigen::VectorXd inverted(double sigma) {
    return (Eigen::VectorXd::LinSpaced(kVertices, 0, kVertices - 1).array() - sigma).inverse();
}

const Eigen::MatrixXd kNone(kVertices, 0);

double orthogonalityError(const Eigen::MatrixXd& Q, const Eigen::VectorXd& D) {
    const Eigen::MatrixXd gram = Q.transpose() * D.asDiagonal() * Q;
    return (gram - Eigen::MatrixXd::Identity(Q.cols(), Q.cols())).cwiseAbs().maxCoeff();
}

/// Semi-orthonormal, T the projection of M to working precision, residuals as they are said to be.
void expectRecurrence(double sigma, Index width) {
    const Example M(inverted(sigma));
    const KnownPairs none{kNone, {}};
    Eigen::MatrixXd Q(kVertices, 90);
    BlockLanczos lanczos(M.apply, M.D, none, width, 1, Q);
    while (lanczos.dimension() + 2 * width <= 80) lanczos.extend();
    const Index m = lanczos.dimension();
    EXPECT_LT(orthogonalityError(Q.leftCols(m), M.D), 1e-6);

    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> ritz(lanczos.T());
    const Eigen::VectorXd residuals = lanczos.residuals(ritz.eigenvectors());
    const double size = M.theta.cwiseAbs().maxCoeff();
    int converged = 0;
    for (Index i = 0; i < m; ++i) {
        const double value = ritz.eigenvalues()[i];
        if (residuals[i] > 1e-9 * std::abs(value)) continue;
        ++converged;
        EXPECT_LT((M.theta.array() - value).abs().minCoeff(), 1e-13 * size);
    }
    EXPECT_GT(converged, width == 4 ? 5 : 15);
}

TEST(BlockLanczos, FindsEigenvaluesToWorkingPrecision) {
    for (const Index width : {1, 2, 4}) {
        SCOPED_TRACE(width);
        expectRecurrence(200.3, width);
    }
}

TEST(BlockLanczos, StandsAShiftVeryNearAnEigenvalue) {
    // One step there undoes the orthogonality of ten.
    expectRecurrence(200.0 + 1e-4, 2);
    expectRecurrence(200.0 - 1e-7, 2);
}

TEST(BlockLanczos, FindsNoPairThatIsKnown) {
    const Example M(inverted(200.4));
    const Eigen::MatrixXd vectors = M.vectors(170, 25);  // next to the 10 that are nearest
    const KnownPairs known{vectors, M.theta.segment(170, 25)};
    Eigen::MatrixXd Q(kVertices, 80);
    BlockLanczos lanczos(M.apply, M.D, known, 2, 1, Q);
    while (lanczos.dimension() < 70) lanczos.extend();
    const Index m = lanczos.dimension();
    EXPECT_LT((vectors.transpose() * M.D.asDiagonal() * Q.leftCols(m)).cwiseAbs().maxCoeff(), 1e-6);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> ritz(lanczos.T());
    const Eigen::VectorXd residuals = lanczos.residuals(ritz.eigenvectors());
    for (Index i = 0; i < m; ++i) {
        if (residuals[i] > 1e-9 * std::abs(ritz.eigenvalues()[i])) continue;
        EXPECT_GT((known.values.array() - ritz.eigenvalues()[i]).abs().minCoeff(), 1e-6);
    }
}

TEST(BlockLanczos, BeginsAnewBesideAnInvariantSpace) {
    // Five eigenvalues, eight copies of each: a block of two sees two copies.
    Eigen::VectorXd theta(40);
    for (Index i = 0; i < 40; ++i) theta[i] = 1.0 + static_cast<double>(i % 5);
    const Example M(theta);
    const Eigen::MatrixXd noVectors(40, 0);
    const KnownPairs none{noVectors, {}};
    Eigen::MatrixXd Q(40, 40);
    BlockLanczos lanczos(M.apply, M.D, none, 2, 1, Q);
    while (!lanczos.exhausted()) lanczos.extend();
    ASSERT_EQ(lanczos.dimension(), 40);
    EXPECT_LT(orthogonalityError(Q, M.D), 1e-7);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> ritz(lanczos.T());
    std::sort(theta.data(), theta.data() + theta.size());
    EXPECT_LT((ritz.eigenvalues() - theta).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(BlockLanczos, EndsWithTheSpaceWhateverTheScalesOfTheEigenvalues) {
    // Beside eigenvalues of 1e-5 the round-off of those of 10 looks like a direction of its own:
    // what is left of a column in a space that is all there is.
    for (const Index n : {23, 40, 60})
        for (const Index width : {1, 2, 3}) {
            Eigen::VectorXd theta(n);
            for (Index i = 0; i < n; ++i)
                theta[i] =
                    std::pow(-10.0, -static_cast<double>(i % 6)) * static_cast<double>(1 + i);
            const Example M(theta);
            const Index count = n / 3;
            const Eigen::MatrixXd vectors = M.vectors(0, count);
            const KnownPairs known{vectors, theta.head(count)};
            Eigen::MatrixXd Q(n, n);
            BlockLanczos lanczos(M.apply, M.D, known, width, 1, Q);
            while (!lanczos.exhausted()) lanczos.extend();
            const Index m = lanczos.dimension();
            EXPECT_LE(m, n - count);
            EXPECT_LT(orthogonalityError(Q.leftCols(m), M.D), 1e-6) << n << ", " << width;
        }
}

TEST(BlockLanczos, IsWholeWhenNothingIsLeft) {
    const Example M(Eigen::VectorXd::LinSpaced(12, 1.0, 2.0));
    const Eigen::MatrixXd vectors = M.vectors(0, 5);
    const KnownPairs known{vectors, M.theta.head(5)};
    Eigen::MatrixXd Q(12, 12);
    BlockLanczos lanczos(M.apply, M.D, known, 2, 1, Q);
    while (!lanczos.exhausted()) lanczos.extend();
    EXPECT_EQ(lanczos.dimension(), 7);
    EXPECT_TRUE(lanczos.isWhole());
}

}  // namespace
}  // namespace spectral
