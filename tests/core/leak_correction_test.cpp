#include "core/leak_correction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/errors.h"
#include "core/rayleigh_ritz.h"
#include "support/evaluation.h"
#include "support/shapes.h"

namespace spectral {
namespace {

using testing::Operator;

/// Harmonics of the basis; the last ones of it, and the first ones beyond, that do not leak.
constexpr Index kHarmonics = 80, kExact = 12;

constexpr double kResidualGain = 0.3;

double lowPass(double omega) { return std::exp(-0.02 * omega * omega); }

/// A basis whose harmonics up to the exact ones have parts of this length beyond those: Ritz
/// vectors, as those of an updated basis are.
HarmonicBasis leaking(const Operator& A, const HarmonicBasis& all, double length) {
    const Index c = A.constants.count(), leaky = kHarmonics - kExact, into = kHarmonics + kExact;
    const Index columns = leaky - c, beyond = all.size() - into;
    std::mt19937 generator(3);
    std::normal_distribution<double> normal;
    // What a step of a filter leaves is smooth: less of it the farther it is in the spectrum.
    Eigen::MatrixXd parts =
        Eigen::MatrixXd::NullaryExpr(beyond, columns, [&] { return normal(generator); });
    for (Index j = 0; j < beyond; ++j)
        parts.row(j) *= std::pow(all.lambda[into] / all.lambda[into + j], 2);
    parts.colwise().normalize();
    Eigen::MatrixXd S = all.Phi.middleCols(c, columns) + length * all.Phi.rightCols(beyond) * parts;

    HarmonicBasis basis;
    ShiftedLdlt factor;
    basis.Phi = all.Phi.leftCols(kHarmonics);
    basis.lambda = all.lambda.head(kHarmonics);
    basis.lambda.segment(c, columns) = rayleighRitz(
        A.laplacian, S, factor.order(A.laplacian), [&] { return columns; }, Progress());
    basis.Phi.middleCols(c, columns) = S;
    basis.leak = {basis.lambda[leaky - 1], all.lambda[into]};
    return basis;
}

class LeakCorrection : public ::testing::Test {
  protected:
    Eigen::MatrixXd exact() const {
        HarmonicBasis basis;
        basis.Phi = all_.Phi.leftCols(kHarmonics);
        basis.lambda = all_.lambda.head(kHarmonics);
        return applied(basis);
    }

    Eigen::MatrixXd applied(const HarmonicBasis& basis) const {
        return applyInBasis(basis, A_.laplacian.D, A_.constants, lowPass, kResidualGain, A_.mesh.V);
    }

    Eigen::MatrixXd corrected(const HarmonicBasis& basis) const {
        ShiftedLdlt factor;
        factor.factorize(A_.laplacian, correctionShift(basis));
        return applyInLeakingBasis(basis, A_.laplacian.D, A_.constants, lowPass, kResidualGain,
                                   A_.mesh.V, factor);
    }

    const Operator A_{testing::withNoise(testing::icosphere(3), 0.03, 5)};
    const HarmonicBasis all_ = denseBasis(A_.laplacian, A_.constants);
};

TEST_F(LeakCorrection, LeavesHundredthsOfTheError) {
    const HarmonicBasis basis = leaking(A_, all_, 1e-4);
    const double before = (applied(basis) - exact()).norm();
    EXPECT_GT(before, 1e-5);
    EXPECT_LT((corrected(basis) - exact()).norm(), 0.02 * before);
}

TEST_F(LeakCorrection, IsOfFirstOrder) {
    // What is left grows with the square of what leaks: faster than what is corrected.
    const auto left = [&](double length) {
        const HarmonicBasis basis = leaking(A_, all_, length);
        return (corrected(basis) - exact()).norm() / (applied(basis) - exact()).norm();
    };
    EXPECT_LT(left(1e-2), 0.1);
    EXPECT_LT(left(1e-4), 0.02);
}

TEST_F(LeakCorrection, OfAnExactBasisChangesNothing) {
    const HarmonicBasis basis = leaking(A_, all_, 0.0);
    EXPECT_LT((corrected(basis) - exact()).norm(), 1e-10 * exact().norm());
}

TEST_F(LeakCorrection, ShiftIsBetweenTwoHarmonics) {
    const HarmonicBasis basis = leaking(A_, all_, 1e-4);
    const double sigma = correctionShift(basis);
    EXPECT_GT(sigma, basis.lambda[0]);
    EXPECT_LT(sigma, basis.leak->from);
    const double spacing = basis.lambda[kHarmonics - 1] / kHarmonics;
    EXPECT_GT((basis.lambda.array() - sigma).abs().minCoeff(), 0.25 * spacing);
}

TEST_F(LeakCorrection, StopsWhenTheCallerWantsIt) {
    const HarmonicBasis basis = leaking(A_, all_, 1e-4);
    ShiftedLdlt factor;
    factor.factorize(A_.laplacian, correctionShift(basis));
    const Progress progress([](double, const std::string&) { return false; });
    EXPECT_THROW(applyInLeakingBasis(basis, A_.laplacian.D, A_.constants, lowPass, kResidualGain,
                                     A_.mesh.V, factor, progress),
                 Cancelled);
}

}  // namespace
}  // namespace spectral
