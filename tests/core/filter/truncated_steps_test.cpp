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
#include "core/support/memory.h"
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

void expectAgreement(const Mesh& mesh, const FilterOptions& options, int computedBases) {
    const FilterResult result = fractionalFilter(mesh.V, mesh.F, options);
    EXPECT_EQ(result.computedBases, computedBases);
    EXPECT_TRUE(result.accuracyReached);
    EXPECT_LT(testing::largestDifference(result.V, withDenseBases(mesh, options)),
              options.evaluation.accuracy * boundingBoxDiagonal(mesh.V));
    EXPECT_GT(testing::largestDifference(result.V, mesh.V), 1e-3 * boundingBoxDiagonal(mesh.V));
}

Mesh roughSphere() { return testing::withNoise(testing::icosphere(3), 0.02, 7); }

TEST(TruncatedSteps, ComputeOneBasisWhereTheResidualIsKept) {
    const Mesh two = testing::joined(testing::icosphere(2), testing::torus(4, 0.8, 24, 10));
    for (const Mesh& mesh : {roughSphere(), two}) {
        FilterOptions options = truncated(mesh, 200);
        expectAgreement(mesh, options, 1);
        options.transferFunction.type = FilterType::HighPass;  // large jump at the end of the basis
        options.transferFunction.passGain = 2.0;
        options.transferFunction.stopGain = 1.0;
        expectAgreement(mesh, options, 1);
        options.transferFunction.passGain = 0.2;
        expectAgreement(mesh, options, 1);
    }
}

TEST(TruncatedSteps, DoNotSplitAClusterOfHarmonics) {
    // 200 harmonics would split those of degree 14, the 197th to the 225th.
    const Mesh mesh = testing::icosphere(3);
    expectAgreement(mesh, truncated(mesh, 200), 1);
}

TEST(TruncatedSteps, ComputeEveryBasisWhereThatIsFaster) {
    const Mesh mesh = roughSphere();
    expectAgreement(mesh, truncated(mesh, 200, false), 3);
    expectAgreement(mesh, truncated(mesh, 50), 3);
}

TEST(TruncatedSteps, ComputeEveryBasisForAGainWithJumps) {
    const Mesh mesh = roughSphere();
    FilterOptions options = truncated(mesh, 200);
    options.transferFunction.response = Response::Ideal;
    expectAgreement(mesh, options, 3);
}

TEST(TruncatedSteps, ComputeEveryBasisOfAlmostAllHarmonics) {
    const Mesh mesh = roughSphere();
    expectAgreement(mesh, truncated(mesh, static_cast<int>(mesh.V.rows()) - 40), 3);
}

TEST(TruncatedSteps, ComputeEveryBasisOnceTheAccuracyIsNotReached) {
    Mesh mesh = roughSphere();
    mesh.V.row(7) *= 30.0;  // needles, whose round-off more solves do not reduce
    FilterOptions options = truncated(mesh, 200);
    options.evaluation.accuracy = 1e-12;
    double last = 0.0;
    const Progress rising([&](double fraction, const std::string&) {
        EXPECT_GE(fraction, last);
        last = fraction;
        return true;
    });
    const FilterResult result = fractionalFilter(mesh.V, mesh.F, options, rising);
    EXPECT_EQ(result.computedBases, 3);
    EXPECT_LT(testing::largestDifference(result.V, withDenseBases(mesh, options)),
              1e-6 * boundingBoxDiagonal(mesh.V));
}

TEST(TruncatedSteps, ComputeEveryBasisWhereMemoryIsShort) {
    const Mesh mesh = roughSphere();
    setMemoryMeasure([] { return 2.5e6; });  // room for 200 harmonics of 642 vertices
    expectAgreement(mesh, truncated(mesh, 200), 3);
    setMemoryMeasure(nullptr);
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
    for (const char* stage : {"counting the harmonics", "computing the harmonics", "filtering"}) {
        const std::string last = std::string("step 2 of 3: ") + stage;
        const Progress progress(
            [&](double, const std::string& text) { return text.find(last) == std::string::npos; });
        EXPECT_THROW(fractionalFilter(mesh.V, mesh.F, truncated(mesh, 200), progress), Cancelled)
            << last;
    }
}

TEST(TruncatedSteps, ReportTheBasisOfTheInputWhereItIsTheOnlyOne) {
    const Mesh mesh = roughSphere();
    const FilterResult result = fractionalFilter(mesh.V, mesh.F, truncated(mesh, 200));
    const testing::Operator A(mesh);
    const Eigen::VectorXd lambda = denseBasis(A).lambda;
    ASSERT_GE(result.eigenvalues.size(), 200);
    EXPECT_EQ(result.inertiaCount, result.eigenvalues.size());
    EXPECT_LT(result.residuals.maxCoeff(), 1e-7);
    EXPECT_LT((result.eigenvalues - lambda.head(result.eigenvalues.size())).cwiseAbs().maxCoeff(),
              1e-8 * lambda[result.eigenvalues.size()]);
}

}  // namespace
}  // namespace spectral
