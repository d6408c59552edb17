#include "core/basis_update.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/fractional_filter.h"
#include "core/leak_correction.h"
#include "support/evaluation.h"
#include "support/shapes.h"

namespace spectral {
namespace {

using testing::Mesh;
using testing::Operator;

constexpr Index kHarmonics = 100;

/// The mesh after the fractional power alpha of a low-pass of this feature size.
Mesh filtered(const Mesh& mesh, double featureSize, double alpha) {
    FilterOptions options;
    options.featureSize = featureSize;
    options.transferFunction.power = alpha;
    options.steps = 1;
    return {fractionalFilter(mesh.V, mesh.F, options).V, mesh.F};
}

HarmonicBasis basisOf(const Operator& A, Index k = kHarmonics) {
    ShiftedCholesky cholesky;
    return truncatedBasis(A.laplacian, A.constants, k, cholesky);
}

BasisUpdateResult update(const Operator& A, HarmonicBasis& basis, Index k = kHarmonics,
                         const Progress& progress = {}) {
    std::vector<ShiftedLdlt> factors;
    return updateBasis(A.laplacian, A.constants, k, UpdateGate(), basis, factors, progress);
}

Mesh lumpy() { return testing::withNoise(testing::icosphere(4), 0.02, 7); }

TEST(BasisUpdate, ComesNearTheBasisFromNothing) {
    const Mesh before = lumpy(), after = filtered(before, 0.5, 0.1);
    const Operator A(after);
    HarmonicBasis basis = basisOf(Operator(before));
    ASSERT_TRUE(update(A, basis).accepted);

    ShiftedCholesky cholesky;
    const HarmonicBasis anew = truncatedBasis(A.laplacian, A.constants, kHarmonics, cholesky);
    ASSERT_EQ(basis.size(), anew.size());
    EXPECT_EQ(basis.inertiaCount, basis.size());
    const Index k = basis.size();
    const Eigen::VectorXd error =
        (basis.lambda.tail(k - 1) - anew.lambda.tail(k - 1)).cwiseQuotient(anew.lambda.tail(k - 1));
    EXPECT_LT(error.cwiseAbs().maxCoeff(), 1e-4);
    EXPECT_GE(error.minCoeff(), -1e-9);  // Ritz values are upper bounds

    const auto DPhi = A.laplacian.D.asDiagonal() * basis.Phi;
    const Eigen::MatrixXd gram = basis.Phi.transpose() * DPhi;
    EXPECT_LT((gram - Eigen::MatrixXd::Identity(gram.rows(), gram.cols())).cwiseAbs().maxCoeff(),
              1e-8);
}

TEST(BasisUpdate, FiltersAsTheBasisFromNothing) {
    const Mesh before = lumpy();
    const Operator A(filtered(before, 0.5, 0.1));
    HarmonicBasis basis = basisOf(Operator(before));
    std::vector<ShiftedLdlt> factors;
    ASSERT_TRUE(
        updateBasis(A.laplacian, A.constants, kHarmonics, UpdateGate(), basis, factors).accepted);
    // The gain jumps at the cut.
    const Gain gain = [](double omega) { return 0.5 + 0.5 / (1.0 + omega); };
    const double rest = 0.2, size = A.mesh.V.rowwise().norm().maxCoeff();
    const auto error = [&](const Eigen::MatrixXd& X) {
        const Eigen::MatrixXd expected =
            applyInBasis(basisOf(A), A.laplacian.D, A.constants, gain, rest, A.mesh.V);
        return (X - expected).rowwise().norm().maxCoeff() / size;
    };
    const double uncorrected =
        error(applyInBasis(basis, A.laplacian.D, A.constants, gain, rest, A.mesh.V));
    const double corrected = error(applyInLeakingBasis(basis, A.laplacian.D, A.constants, gain,
                                                       rest, A.mesh.V, factors.front()));
    EXPECT_LT(corrected, 1e-6);
    EXPECT_LT(corrected, 0.1 * uncorrected);
}

TEST(BasisUpdate, OfTheSameLaplacianChangesNothing) {
    const Operator A(lumpy());
    HarmonicBasis basis = basisOf(A);
    const Eigen::VectorXd lambda = basis.lambda;
    ASSERT_TRUE(update(A, basis).accepted);
    EXPECT_LT((basis.lambda - lambda).cwiseAbs().maxCoeff(), 1e-9 * lambda[lambda.size() - 1]);
    EXPECT_LT(basis.residuals.maxCoeff(), 1e-6);
}

TEST(BasisUpdate, IsRefusedAfterALargeStep) {
    const Mesh before = testing::withNoise(testing::cube(16), 0.03, 3);
    Mesh after = before;  // squeezed flat, with all its lengths changed
    after.V.col(2) *= 0.05;
    after.V.col(0) = after.V.col(0).array() * (1.0 + 0.5 * after.V.col(0).array());
    const Operator A(after);
    HarmonicBasis basis = basisOf(Operator(before));
    EXPECT_FALSE(update(A, basis).accepted);
}

TEST(BasisUpdate, IsExactNextToTheCut) {
    const Mesh before = lumpy();
    const Operator A(filtered(before, 0.5, 0.1));
    HarmonicBasis basis = basisOf(Operator(before));
    ASSERT_TRUE(update(A, basis).accepted);
    const HarmonicBasis anew = basisOf(A);
    ASSERT_EQ(basis.size(), anew.size());
    EXPECT_LT((basis.lambda.tail(8) - anew.lambda.tail(8)).cwiseAbs().maxCoeff(),
              1e-10 * anew.lambda[anew.size() - 1]);
    // What one basis spans and the other does not: the sines of the angles between them.
    const Eigen::MatrixXd DPhi = A.laplacian.D.asDiagonal() * anew.Phi;
    const Eigen::MatrixXd rest = basis.Phi - anew.Phi * (DPhi.transpose() * basis.Phi);
    EXPECT_LT((A.laplacian.D.cwiseSqrt().asDiagonal() * rest).colwise().norm().maxCoeff(), 1e-3);
}

/// Relative difference of the eigenvalues of an updated basis, to the largest one, from those of a
/// basis from nothing. The run at the cut may overlook copies of multiple eigenvalues, on both
/// sides of its shift and of the cut: the update has to notice.
double errorOfUpdate(const Mesh& before, Index k, double power) {
    const Operator A(filtered(before, 0.7, power));
    HarmonicBasis basis = basisOf(Operator(before), k);
    EXPECT_TRUE(update(A, basis, k).accepted);
    EXPECT_TRUE(std::is_sorted(basis.lambda.begin(), basis.lambda.end()));
    const HarmonicBasis anew = basisOf(A, k);
    EXPECT_EQ(basis.size(), anew.size());
    if (basis.size() != anew.size()) return 1.0;
    return (basis.lambda - anew.lambda).cwiseAbs().maxCoeff() / anew.lambda[anew.size() - 1];
}

TEST(BasisUpdate, OfASphereHasAllCopiesOfItsEigenvalues) {
    for (const int subdivisions : {3, 4})
        for (const Index k : {80, 128})
            for (const double power : {0.01, 0.05, 0.1})
                EXPECT_LT(errorOfUpdate(testing::icosphere(subdivisions), k, power), 1e-6)
                    << subdivisions << " subdivisions, k = " << k << ", power " << power;
}

TEST(BasisUpdate, OfACubeHasAllCopiesOfItsEigenvalues) {
    for (const Index k : {80, 128})
        for (const double power : {0.01, 0.05, 0.1})
            EXPECT_LT(errorOfUpdate(testing::cube(16), k, power), 1e-5)
                << "k = " << k << ", power " << power;
}

TEST(BasisUpdate, IsRefusedWhereTheOldBasisIsTooSmall) {
    const Operator A(lumpy());
    HarmonicBasis basis = basisOf(A);
    EXPECT_FALSE(update(A, basis, basis.size() + 1).accepted);
}

TEST(BasisUpdate, DoesNotDependOnTheThreads) {
    const Mesh before = lumpy();
    const Operator A(filtered(before, 0.5, 0.1));
    const HarmonicBasis start = basisOf(Operator(before));
    HarmonicBasis once = start, again = start;
    update(A, once);
    update(A, again);
    EXPECT_TRUE((once.Phi.array() == again.Phi.array()).all());
}

TEST(BasisUpdate, DoesNotDependOnTheFactorsOfAnother) {
    const Operator first(filtered(lumpy(), 0.5, 0.1)), other(testing::cube(12));
    const HarmonicBasis start = basisOf(Operator(lumpy()));
    std::vector<ShiftedLdlt> factors;
    for (const Operator* A : {&first, &first, &other, &first}) {
        HarmonicBasis basis = A == &other ? basisOf(other) : start, anew = basis;
        ASSERT_TRUE(
            updateBasis(A->laplacian, A->constants, kHarmonics, UpdateGate(), basis, factors)
                .accepted);
        ASSERT_TRUE(update(*A, anew).accepted);
        EXPECT_TRUE((basis.Phi.array() == anew.Phi.array()).all());
    }
}

TEST(BasisUpdate, StopsWhenTheCallerWantsIt) {
    const Operator A(lumpy());
    HarmonicBasis basis = basisOf(A);
    const Progress progress([](double, const std::string&) { return false; });
    EXPECT_THROW(update(A, basis, kHarmonics, progress), Cancelled);
}

TEST(BasisUpdate, OfASphereTellsItsProgressAndStopsAnywhere) {
    // Copies of multiple eigenvalues take runs of their own.
    const Mesh before = testing::icosphere(3);
    const Operator A(filtered(before, 0.7, 0.1));
    const HarmonicBasis start = basisOf(Operator(before));
    HarmonicBasis basis = start;
    double last = 0.0;
    const Progress rising([&](double fraction, const std::string&) {
        EXPECT_GE(fraction, last);
        last = fraction;
        return true;
    });
    EXPECT_TRUE(update(A, basis, kHarmonics, rising).accepted);
    EXPECT_GT(last, 0.9);
    for (const double end : {0.05, 0.3, 0.51, 0.56, 0.8}) {
        basis = start;
        const Progress progress(
            [&](double fraction, const std::string&) { return fraction < end; });
        EXPECT_THROW(update(A, basis, kHarmonics, progress), Cancelled) << end;
    }
}

FilterOptions truncatedSteps(double featureSize, int steps) {
    FilterOptions options;
    options.featureSize = featureSize;
    options.steps = steps;
    options.evaluation.spectrum = Spectrum::Truncated;
    options.evaluation.basisSize = static_cast<int>(kHarmonics);
    return options;
}

TEST(TruncatedSteps, UpdateTheBasisAfterTheFirst) {
    const Mesh mesh = lumpy();
    const FilterResult result = fractionalFilter(mesh.V, mesh.F, truncatedSteps(0.5, 5));
    EXPECT_EQ(result.computedBases, 1);
    EXPECT_EQ(result.updatedBases, 4);
    EXPECT_EQ(result.inertiaCount, result.eigenvalues.size());
}

TEST(TruncatedSteps, ComputeTheBasisAnewWhereTheGateTrips) {
    const Mesh mesh = testing::withNoise(testing::cube(16), 0.05, 3);
    FilterOptions options = truncatedSteps(0.5, 2);  // each step multiplies what is small by four
    options.transferFunction.type = FilterType::HighPass;
    options.transferFunction.stopGain = 1.0;
    options.transferFunction.passGain = 16.0;
    const FilterResult result = fractionalFilter(mesh.V, mesh.F, options);
    EXPECT_EQ(result.computedBases, 2);
    EXPECT_EQ(result.updatedBases, 0);
    EXPECT_LT(result.residuals.maxCoeff(), 1e-7);
}

}  // namespace
}  // namespace spectral
