#include "core/harmonics/truncated_basis.h"

#include <gtest/gtest.h>

#include "core/analysis/manifold_harmonics.h"
#include "core/support/errors.h"
#include "support/evaluation.h"
#include "support/shapes.h"

namespace spectral {
namespace {

using testing::lowestHarmonics;
using testing::Mesh;
using testing::Operator;

/// Compares with the dense solver: no eigenvalue is missing, none appears twice.
void expectLowest(const Mesh& mesh, Index k, const char* name) {
    SCOPED_TRACE(name);
    const Operator A(mesh);
    const HarmonicBasis pairs = lowestHarmonics(A, k);
    const Eigen::VectorXd lambda = denseBasis(A).lambda;
    ASSERT_GE(pairs.lambda.size(), k);
    const Index c = A.constants.count(), found = pairs.lambda.size();
    const Eigen::VectorXd error = pairs.lambda - lambda.head(found);
    EXPECT_LT(error.cwiseAbs().maxCoeff(), 1e-9 * lambda[found - 1]);

    EXPECT_LT(testing::orthonormalityError(pairs.Phi, A.D), 1e-7);
    const Eigen::MatrixXd residual =
        A.W * pairs.Phi - A.D.asDiagonal() * pairs.Phi * pairs.lambda.asDiagonal();
    for (Index i = c; i < found; ++i)
        EXPECT_LT(residual.col(i).cwiseQuotient(A.D.cwiseSqrt()).norm(), 1e-7 * pairs.lambda[i]);
}

Mesh copies(const Mesh& mesh, int count) {
    Mesh all = mesh;
    for (int i = 1; i < count; ++i) all = testing::joined(all, mesh);
    return all;
}

TEST(TruncatedBasisSlices, MissNoPair) {
    expectLowest(testing::blob(), 150, "no symmetry");
    expectLowest(testing::withNoise(testing::rectangle(2, 1, 40, 20), 0.01, 5), 200, "boundary");
}

TEST(TruncatedBasisSlices, FindEveryCopyOfAMultipleEigenvalue) {
    expectLowest(testing::icosphere(3), 120, "sphere");
    expectLowest(testing::cube(12), 120, "cube");
    expectLowest(testing::rectangle(1, 1, 24, 24), 100, "square");
    expectLowest(copies(testing::icosphere(2), 5), 100, "five equal spheres");
}

TEST(TruncatedBasisSlices, MissNoPairOfManyEqualParts) {
    // Few eigenvalues with wide gaps: a Lanczos run finds none on one side of its shift.
    expectLowest(copies(testing::icosphere(1), 20), 60, "twenty spheres");
    expectLowest(copies(testing::cube(2), 40), 300, "forty cubes");
}

TEST(TruncatedBasisSlices, MissNoPairOfALargeCoarsePartAndASmallFineOne) {
    // A floor of four vertices under a scanned object has nearly all of the area, so Weyl's law
    // puts the first shifts far below the object's eigenvalues.
    Mesh floor = testing::rectangle(20, 20, 1, 1), hall = testing::icosphere(1);
    hall.V *= 20.0;
    expectLowest(testing::joined(floor, testing::blob()), 60, "floor");
    expectLowest(testing::joined(hall, testing::blob()), 100, "hall");
}

TEST(TruncatedBasisSlices, AreFewWhenFewPairsAreRequested) {
    expectLowest(testing::blob(), 2, "one harmonic");
    expectLowest(testing::icosphere(3), 5, "within a group of equal ones");
}

TEST(TruncatedBasisSlices, StopOnRequest) {
    const Operator A(testing::icosphere(4));
    int reports = 0;
    const Progress progress([&](double fraction, const std::string&) {
        EXPECT_GE(fraction, 0.0);
        EXPECT_LE(fraction, 1.0);
        return ++reports < 2;  // there are many spectral intervals
    });
    EXPECT_THROW(lowestHarmonics(A, 100, progress), Cancelled);
}

TEST(TruncatedBasisSlices, ReportRisingProgress) {
    const Operator A(testing::icosphere(4));
    double last = 0.0;
    const Progress rising([&](double fraction, const std::string&) {
        EXPECT_GE(fraction, last);
        last = fraction;
        return true;
    });
    lowestHarmonics(A, 100, rising);
    EXPECT_GT(last, 0.9);
}

TEST(TruncatedBasis, RejectsHarmonicsLostInRoundOff) {
    // Both with the dense solver and in spectral intervals.
    for (const auto& [levels, spike] : {std::pair<int, double>{2, 1e14}, {3, 1e7}}) {
        Mesh mesh = testing::withNoise(testing::icosphere(levels), 0.03, 4);
        mesh.V.row(7) *= spike;
        HarmonicsOptions options;
        options.basisSize = 20;
        try {
            manifoldHarmonics(mesh.V, mesh.F, options);
            ADD_FAILURE() << levels;
        } catch (const SolverFailure& failure) {
            EXPECT_EQ(failure.code(), ErrorCode::SingularMatrix) << failure.what();
        }
    }
}

TEST(TruncatedBasis, ToleratesASpikeOnASmallMesh) {
    // The lowest harmonic is that of its tip, the next four are those of its sides; those of the
    // rest of the surface do not depend on its length.
    const auto eigenvalues = [](double spike) {
        Mesh mesh = testing::withNoise(testing::icosphere(2), 0.03, 4);
        mesh.V.row(7) *= spike;
        HarmonicsOptions options;
        options.basisSize = 20;
        return manifoldHarmonics(mesh.V, mesh.F, options).lambda;
    };
    const Eigen::ArrayXd ratio = eigenvalues(1e5).array() / eigenvalues(1e6).array();
    EXPECT_NEAR(ratio[1], 100.0, 0.1);
    for (int i = 2; i < 20; ++i) EXPECT_NEAR(ratio[i], i < 6 ? 10.0 : 1.0, 1e-2) << i;
}

}  // namespace
}  // namespace spectral
