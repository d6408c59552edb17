#include "core/support/memory.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/denoise/denoise.h"
#include "core/filter/fractional_filter.h"
#include "core/harmonics/truncated_basis.h"
#include "core/support/errors.h"
#include "core/support/system_memory.h"
#include "support/evaluation.h"

namespace spectral {
namespace {

using testing::Operator;

/// Limits the memory to what the program already uses, plus a given amount.
class Memory : public ::testing::Test {
  protected:
    void SetUp() override {
        if (std::isinf(residentMemory())) GTEST_SKIP() << "not available on this system";
    }
    static void limitTo(double megabytesMore) {
        setMemoryLimit(residentMemory() + 1e6 * megabytesMore);
    }
    void TearDown() override {
        setMemoryLimit(0.0);
        setMemoryMeasure(nullptr);
    }
};

TEST_F(Memory, IsThatOfTheSystemIfUnlimited) {
    EXPECT_GT(availableMemory(), 1e6);
    limitTo(1.0);
    EXPECT_LT(availableMemory(), 1e9);
    setMemoryLimit(1.0);
    EXPECT_EQ(availableMemory(), 0.0);
}

TEST_F(Memory, IsCheckedBeforeAFactorIsAllocated) {
    const Operator A(testing::blob());
    setMemoryLimit(1.0);
    ShiftedLdlt ldlt;
    try {
        ldlt.factorizeDefinite(A.W, A.D, 1.0);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::OutOfMemory) << error.what();
    }
    setMemoryLimit(0.0);
    ldlt.factorizeDefinite(A.W, A.D, 1.0);
}

TEST_F(Memory, EndsAutomaticStepsAtOnce) {
    const testing::Mesh mesh = testing::blob();
    FilterOptions options;
    options.featureSize = 0.3;
    options.tolerance = 1e-3;
    setMemoryLimit(1.0);
    try {
        fractionalFilter(mesh.V, mesh.F, options);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::OutOfMemory) << error.what();
    }
}

TEST_F(Memory, IsCheckedBeforeNoiseIsMeasured) {
    const testing::Mesh mesh = testing::withNoise(testing::icosphere(4), 0.01, 1);
    setMemoryLimit(1.0);
    try {
        denoise(mesh.V, mesh.F, {});
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::OutOfMemory) << error.what();
    }
    setMemoryLimit(0.0);
    EXPECT_GT(denoise(mesh.V, mesh.F, {}).maxDisplacement, 0.0);
}

TEST_F(Memory, SufficesForProductsIfTooSmallForAFactorization) {
    // 40,962 vertices, 41 MB for the analysis alone; products are expensive for so steep a cutoff.
    const testing::Mesh mesh = testing::withNoise(testing::icosphere(6), 0.01, 1);
    FilterOptions options;
    options.transferFunction.response = Response::Butterworth;
    options.transferFunction.order = 6;
    options.featureSize = 0.3;
    options.tolerance = 1e-3;
    const FilterResult best = fractionalFilter(mesh.V, mesh.F, options);
    EXPECT_GT(best.factorizations, 0);
    EXPECT_FALSE(best.lacksMemory);
    setMemoryMeasure([] { return 3e7; });  // independent of what the first run left in the heap
    const FilterResult result = fractionalFilter(mesh.V, mesh.F, options);
    EXPECT_TRUE(result.lacksMemory);
    EXPECT_EQ(result.factorizations, 0);
    EXPECT_TRUE(result.accuracyReached);
    EXPECT_LE(testing::largestDifference(result.V, best.V), 1e-3);
}

TEST_F(Memory, IsCheckedForABasisAndTheErrorNamesTheSizeThatFits) {
    const Operator A(testing::icosphere(5));  // 10,242 vertices: 10 MB for 100 harmonics
    limitTo(50.0);
    ShiftedLdlt ldlt;
    try {
        truncatedBasis(A, 5000, ldlt);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::BasisOutOfMemory) << error.what();
        EXPECT_GT(error.limit(), 10);
        EXPECT_LT(error.limit(), 5000);
    }
}

TEST_F(Memory, OfABasisIsForecastWithItsFactorization) {
    const Operator A(testing::icosphere(5));  // 10 MB for the factor, 10 MB for 100 harmonics
    limitTo(15.0);
    ShiftedLdlt ldlt;
    try {
        truncatedBasis(A, 100, ldlt);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::BasisOutOfMemory) << error.what();
        EXPECT_LT(error.limit(), 100);
    }
    limitTo(5.0);
    try {
        truncatedBasis(A, 20, ldlt);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::OutOfMemory) << error.what();
    }
    EXPECT_EQ(ldlt.factorizations(), 0);
}

}  // namespace
}  // namespace spectral
