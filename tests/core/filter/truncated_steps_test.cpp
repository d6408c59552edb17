#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "core/filter/fractional_filter.h"
#include "core/harmonics/harmonic_basis.h"
#include "core/harmonics/truncated_basis.h"
#include "core/laplacian/laplacian.h"
#include "core/mesh/measures.h"
#include "core/mesh/surface.h"
#include "core/support/frequency.h"
#include "core/support/progress.h"
#include "core/support/threads.h"
#include "core/transfer/transfer_function.h"
#include "support/evaluation.h"
#include "support/shapes.h"

namespace spectral {
namespace {

using testing::Mesh;

FilterOptions truncated(const Mesh& mesh, int k, bool reinjectResidual = true) {
    FilterOptions options;
    options.featureSize = 0.2 * boundingBoxDiagonal(mesh.V);
    options.steps = 3;
    options.laplacian = LaplacianKind::Cotangent;
    options.basisUpdate = BasisUpdate::Full;
    options.evaluation.spectrum = Spectrum::Truncated;
    options.evaluation.truncation = {k, reinjectResidual};
    return options;
}

/// The same steps with all eigenvectors of every shape, by the dense solver.
Vertices withDenseBases(const Mesh& mesh, const FilterOptions& options) {
    const TransferFunction F(options.transferFunction, cutoffFrequency(options.featureSize));
    const double alpha = 1.0 / options.steps;
    Vertices X = mesh.V;
    for (int step = 0; step < options.steps; ++step) {
        const Laplacian laplacian = testing::cotangentLaplacian(X, mesh.F);
        HarmonicBasis basis = denseBasis(laplacian);
        const double highest = std::sqrt(basis.lambda[basis.size() - 1]);
        const Index k =
            cutOutsideClusters(basis.lambda, options.evaluation.truncation.basisSize).value();
        basis.Phi.conservativeResize(Eigen::NoChange, k);
        basis.lambda.conservativeResize(k);
        const double rest = options.evaluation.truncation.reinjectResidual
                                ? meanGain(F, std::sqrt(basis.lambda[k - 1]), highest)
                                : 0.0;
        X = applyInBasis(basis, laplacian, fractionalPower(F, alpha), std::pow(rest, alpha), X);
    }
    return X;
}

void expectAgreement(const Mesh& mesh, const FilterOptions& options) {
    const FilterResult result = fractionalFilter(mesh.V, mesh.F, options);
    EXPECT_EQ(result.computedBases, options.steps);
    EXPECT_TRUE(result.accuracyReached);
    EXPECT_LT(testing::largestDifference(result.V, withDenseBases(mesh, options)),
              options.evaluation.accuracy * boundingBoxDiagonal(mesh.V));
    EXPECT_GT(testing::largestDifference(result.V, mesh.V), 1e-3 * boundingBoxDiagonal(mesh.V));
}

Mesh roughSphere() { return testing::withNoise(testing::icosphere(3), 0.02, 7); }

TEST(TruncatedSteps, AreThoseInAllEigenvectorsOfEveryShape) {
    const Mesh two = testing::joined(testing::icosphere(2), testing::torus(4, 0.8, 24, 10));
    for (const Mesh& mesh : {roughSphere(), two}) {
        FilterOptions options = truncated(mesh, 200);
        expectAgreement(mesh, options);
        options.transferFunction.type = FilterType::HighPass;  // large jump at the end of the basis
        options.transferFunction.passGain = 2.0;
        options.transferFunction.stopGain = 1.0;
        expectAgreement(mesh, options);
    }
    expectAgreement(roughSphere(), truncated(roughSphere(), 200, false));
}

TEST(TruncatedSteps, DoNotSplitAClusterOfHarmonics) {
    // 200 harmonics would split those of degree 14, the 197th to the 225th.
    const Mesh mesh = testing::icosphere(3);
    expectAgreement(mesh, truncated(mesh, 200));
}

TEST(TruncatedSteps, TakeAGainWithJumps) {
    const Mesh mesh = roughSphere();
    FilterOptions options = truncated(mesh, 200);
    options.transferFunction.response = Response::Ideal;
    expectAgreement(mesh, options);
}

TEST(TruncatedSteps, TakeAlmostAllHarmonics) {
    const Mesh mesh = roughSphere();
    expectAgreement(mesh, truncated(mesh, static_cast<int>(mesh.V.rows()) - 40));
}

TEST(TruncatedSteps, AreBitIdenticalForEveryNumberOfThreads) {
    const Mesh mesh = testing::withNoise(testing::icosphere(4), 0.02, 7);  // several blocks of rows
    std::vector<Vertices> results;
    for (const int threads : {1, 2, 3}) {
        setThreadCount(threads);
        results.push_back(fractionalFilter(mesh.V, mesh.F, truncated(mesh, 200)).V);
    }
    setThreadCount(0);
    EXPECT_TRUE(results[0] == results[1]);
    EXPECT_TRUE(results[0] == results[2]);
}

TEST(TruncatedSteps, StopWhenTheCallerCancels) {
    const Mesh mesh = roughSphere();
    for (const char* stage : {"counting the harmonics", "computing the harmonics"}) {
        const std::string last = std::string("step 2 of 3: ") + stage;
        const Progress progress(
            [&](double, const std::string& text) { return text.find(last) == std::string::npos; });
        EXPECT_THROW(fractionalFilter(mesh.V, mesh.F, truncated(mesh, 200), progress), Cancelled)
            << last;
    }
}

}  // namespace
}  // namespace spectral
