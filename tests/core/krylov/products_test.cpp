#include <gtest/gtest.h>

#include <cmath>

#include "core/krylov/full_spectrum.h"
#include "core/krylov/krylov_operator.h"
#include "core/laplacian/laplacian_builder.h"
#include "core/support/memory.h"
#include "core/transfer/transfer_function.h"
#include "support/evaluation.h"

namespace spectral {
namespace {

using testing::Mesh;
using testing::Operator;

constexpr double kRoundOff = 1e-12;

std::vector<FullSpectrumResult> byProducts(const Operator& A, const TransferFunction& F,
                                           double alpha, const FullSpectrumOptions& options) {
    return applyFullSpectrum(A, Products(A, F.cutoff()), {fractionalPower(F, alpha)}, A.mesh.V,
                             options);
}

TEST(Products, EqualAllEigenvectorsWithinTheRequestedAccuracy) {
    for (const Mesh& mesh : {testing::blob(), testing::withNoise(testing::cube(8), 0.02, 4),
                             testing::withNoise(testing::rectangle(2, 1, 24, 12), 0.03, 3),
                             testing::joined(testing::blob(), testing::torus(2, 0.7, 24, 12))}) {
        const Operator A(mesh);
        const HarmonicBasis dense = denseBasis(A);
        for (const auto& transfer : testing::smoothTransferFunctions())
            for (const double alpha : {1.0, 0.1})
                for (const double accuracy : {1e-4, 1e-6, 1e-9})
                    for (const bool atEveryVertex : {false, true}) {
                        const TransferFunction F(transfer, 2.0 * kPi / 0.5);
                        FullSpectrumOptions options;
                        options.accuracy = accuracy;
                        options.atEveryVertex = atEveryVertex;
                        options.samples = F.samples();
                        const FullSpectrumResult result = byProducts(A, F, alpha, options).front();
                        const Vertices error =
                            result.Y - testing::filteredDense(A, dense, fractionalPower(F, alpha));
                        const Eigen::VectorXd& D = A.D;
                        Vertices X = A.mesh.V;
                        A.constants.remove(X);
                        const double relative =
                            atEveryVertex ? testing::relativeError(A, error)
                                          : std::sqrt(D.dot(error.rowwise().squaredNorm()) /
                                                      D.dot(X.rowwise().squaredNorm()));
                        EXPECT_LE(relative, result.errorEstimate + kRoundOff)
                            << testing::describe(transfer) << ", alpha " << alpha << ", accuracy "
                            << accuracy << ", dimension " << result.dimension;
                    }
    }
}

TEST(Products, AreRepeatedWhenABasisDoesNotFitInMemory) {
    const Operator A(
        testing::joined(testing::blob(), testing::withNoise(testing::cube(8), 0.02, 4)));
    const HarmonicBasis dense = denseBasis(A);
    const TransferFunction F({}, 2.0 * kPi / 0.5);
    FullSpectrumOptions options;
    options.accuracy = 1e-5;
    options.atEveryVertex = false;
    options.samples = F.samples();
    const auto filtered = [&] {
        return applyFullSpectrum(A, Products(A, F.cutoff()),
                                 {fractionalPower(F, 1.0), fractionalPower(F, 0.5)}, A.mesh.V,
                                 options);
    };
    const auto kept = filtered();
    setMemoryMeasure([] { return 5e5; });  // 200 dimensions of 1,028 vertices need 2.5 MB
    const auto repeated = filtered();
    setMemoryMeasure(nullptr);
    for (const std::size_t g : {0, 1}) {
        EXPECT_EQ(repeated[g].dimension, kept[g].dimension);
        EXPECT_GT((repeated[g].Y - kept[g].Y).norm(), 0.0);  // not the same code path
        EXPECT_LE((repeated[g].Y - kept[g].Y).norm(), 1e-6 * kept[g].Y.norm());
        const Vertices error =
            repeated[g].Y -
            testing::filteredDense(A, dense, fractionalPower(F, g == 0 ? 1.0 : 0.5));
        EXPECT_LE(std::sqrt(A.D.dot(error.rowwise().squaredNorm())),
                  repeated[g].errorEstimate * std::sqrt(A.D.sum()) *
                      A.mesh.V.rowwise().norm().maxCoeff());
    }
}

TEST(Products, GiveUpWhenTooManyAreExpected) {
    const Operator A(testing::withNoise(testing::icosphere(4), 0.02, 5));
    TransferFunctionOptions steep;
    steep.response = Response::Butterworth;
    steep.order = 8;
    const TransferFunction F(steep, 2.0 * kPi / 1.0);
    FullSpectrumOptions options;
    options.atEveryVertex = false;
    const int needed = byProducts(A, F, 1.0, options).front().dimension;
    ASSERT_GT(needed, 20);
    options.affordable = needed / 2;
    EXPECT_TRUE(byProducts(A, F, 1.0, options).empty());
    options.affordable = 3 * needed;
    EXPECT_EQ(byProducts(A, F, 1.0, options).size(), 1U);
}

TEST(LaplacianBuilder, TakesTheMassesOfTheShapeInAConformalUpdate) {
    const Mesh mesh = testing::blob();
    const Surface surface = surfaceOf(mesh.V, mesh.F);
    const Components components = connectedComponents(surface.F, surface.X.rows());
    LaplacianBuilder laplacians(surface, components, LaplacianKind::IntrinsicDelaunay,
                                BasisUpdate::Conformal);
    const Eigen::VectorXd D = laplacians.current().D;
    const Vertices halved = 0.5 * surface.X, tenth = 0.1 * surface.X;
    laplacians.update(halved);
    EXPECT_TRUE(laplacians.current().D.isApprox(0.25 * D, 1e-12));
    laplacians.update(tenth);
    EXPECT_TRUE(laplacians.current().D.isApprox(0.01 * D, 1e-12));
    EXPECT_NEAR(laplacians.area(), 0.01 * D.sum(), 1e-12 * D.sum());

    laplacians.reset();
    EXPECT_EQ(laplacians.current().D, D);

    // Factors multiply masses, but are no area.
    laplacians.scaleMass(Eigen::VectorXd::Constant(D.size(), 3.0));
    EXPECT_EQ(laplacians.current().D, 3.0 * D);
    laplacians.update(tenth);
    EXPECT_TRUE(laplacians.current().D.isApprox(0.03 * D, 1e-12));
    EXPECT_NEAR(laplacians.area(), 0.01 * D.sum(), 1e-12 * D.sum());
    EXPECT_EQ(laplacians.inputMass(), D);

    LaplacianBuilder full(surface, components, LaplacianKind::IntrinsicDelaunay, BasisUpdate::Full);
    full.update(tenth);
    EXPECT_TRUE(full.current().D.isApprox(0.01 * D, 1e-12));
}

}  // namespace
}  // namespace spectral
