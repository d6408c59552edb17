// The evaluations against each other on real meshes: decimated samples of pymeshlab, written by
// export_sample_meshes.py before these tests run.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "core/analysis/geometry_spectrum.h"
#include "core/filter/fractional_filter.h"
#include "core/harmonics/truncated_basis.h"
#include "core/laplacian/interior.h"
#include "core/laplacian/intrinsic_delaunay.h"
#include "core/mesh/measures.h"
#include "core/mesh/mesh.h"
#include "core/transfer/transfer_function.h"
#include "support/evaluation.h"

namespace spectral {
namespace {

using testing::Mesh;
using testing::Operator;

/// The W that export_sample_meshes.py has written next to a mesh.
SparseMatrix readStiffness(const std::string& path, Index n) {
    std::ifstream in(path, std::ios::binary);
    std::vector<Eigen::Triplet<double>> entries;
    std::array<double, 3> entry;
    while (in.read(reinterpret_cast<char*>(entry.data()), sizeof entry))
        entries.emplace_back(static_cast<int>(entry[0]), static_cast<int>(entry[1]), entry[2]);
    SparseMatrix W(n, n);
    W.setFromTriplets(entries.begin(), entries.end());
    return W;
}

class RealMesh : public ::testing::TestWithParam<const char*> {
  protected:
    void SetUp() override {
        path_ = std::string(SPECTRAL_TEST_MESHES) + "/" + GetParam();
        const std::string path = path_ + ".ply";
        if (!std::filesystem::exists(path))
            GTEST_SKIP() << path << " is missing: it is exported by a Python with pymeshlab";
        mesh_ = testing::readPly(path);
        diagonal_ = boundingBoxDiagonal(mesh_.V);
    }

    double largestDifference(const Vertices& A, const Vertices& B) const {
        return (A - B).rowwise().norm().maxCoeff() / diagonal_;
    }

    std::string path_;  // without the ending
    Mesh mesh_;
    double diagonal_ = 0.0;
};

TEST_P(RealMesh, FullSpectrumEqualsDenseForEverySmoothTransferFunction) {
    const Operator A(mesh_);
    ASSERT_LE(mesh_.V.rows(), 3000);
    const HarmonicBasis dense = denseBasis(A);
    for (const double feature : {0.1, 0.3})
        for (const auto& options : testing::smoothTransferFunctions()) {
            const TransferFunction F(options, 2.0 * kPi / (feature * diagonal_));
            const Gain gain = fractionalPower(F, 1.0);
            const FullSpectrumResult result =
                testing::filteredFullSpectrum(A, gain, F.cutoff(), 1e-6);
            const Vertices expected = testing::filteredDense(A, dense, gain);
            EXPECT_TRUE(result.converged) << testing::describe(options);
            EXPECT_LE(testing::relativeError(A, result.Y - expected), 1e-6)
                << testing::describe(options);
            EXPECT_LE(largestDifference(result.Y, expected), 1e-6) << testing::describe(options);
        }
}

TEST_P(RealMesh, TruncatedWithAllHarmonicsEqualsDense) {
    const Operator A(mesh_);
    const HarmonicBasis dense = denseBasis(A);
    const TransferFunction F({}, 2.0 * kPi / (0.2 * diagonal_));
    const Gain gain = fractionalPower(F, 1.0);
    // With all n eigenvectors there is no residual.
    EXPECT_LT(largestDifference(applyInBasis(dense, A, gain, 0.5, mesh_.V),
                                testing::filteredDense(A, dense, gain)),
              1e-12);

    // With all but the last one, the residual is that harmonic alone.
    ShiftedLdlt ldlt;
    const Index n = mesh_.V.rows();
    const HarmonicBasis basis = truncatedBasis(A, n - 1, ldlt);
    const double last = gain(std::sqrt(dense.lambda[n - 1]));
    EXPECT_LT(largestDifference(applyInBasis(basis, A, gain, last, mesh_.V),
                                testing::filteredDense(A, dense, gain)),
              1e-8);
}

TEST_P(RealMesh, TruncatedBasisEqualsTheLowestOfTheDenseOne) {
    const Operator A(mesh_);
    const HarmonicBasis dense = denseBasis(A);
    ShiftedLdlt ldlt;
    const HarmonicBasis basis = truncatedBasis(A, 200, ldlt);
    EXPECT_LT((basis.lambda - dense.lambda.head(basis.size())).cwiseAbs().maxCoeff(),
              1e-9 * dense.lambda[basis.size() - 1]);
}

TEST_P(RealMesh, FullSpectrumAndTruncatedAgreeWhereTheGainVanishesBeyondTheBasis) {
    FilterOptions options;
    options.featureSize = 0.5 * diagonal_;
    options.steps = 1;
    options.evaluation.accuracy = 1e-9;
    const Vertices full = fractionalFilter(mesh_.V, mesh_.F, options).V;
    options.evaluation.spectrum = Spectrum::Truncated;
    options.evaluation.truncation.basisSize = 500;
    options.evaluation.truncation.reinjectResidual = false;
    const Vertices truncated = fractionalFilter(mesh_.V, mesh_.F, options).V;
    EXPECT_LT(largestDifference(full, truncated), 1e-7);
}

TEST_P(RealMesh, OctavesOfTheGeometrySpectrumAreThoseOfAllEigenvectors) {
    SpectrumOptions options;
    options.basisSize = static_cast<int>(mesh_.V.rows());
    const GeometrySpectrum dense = geometrySpectrum(mesh_.V, mesh_.F, options);
    for (const int basisSize : {10, 200}) {
        options.basisSize = basisSize;
        const GeometrySpectrum spectrum = geometrySpectrum(mesh_.V, mesh_.F, options);
        ASSERT_EQ(spectrum.octaveEnergies.size(), dense.octaveEnergies.size());
        for (Index j = 0; j < dense.octaveEnergies.size(); ++j)
            EXPECT_NEAR(spectrum.octaveEnergies[j] / dense.octaveEnergies[j], 1.0, 2e-3)
                << "basis " << basisSize << ", octave " << j;
    }
}

class OpenRealMesh : public RealMesh {};

TEST_P(OpenRealMesh, WithAFixedBoundaryFullSpectrumAndTruncatedAgree) {
    // A gain that is constant beyond the basis: the residual is then exact.
    FilterOptions options;
    options.featureSize = 0.5 * diagonal_;
    options.steps = 1;
    options.boundary = Boundary::Fixed;
    options.evaluation.accuracy = 1e-9;
    const FilterResult full = fractionalFilter(mesh_.V, mesh_.F, options);
    EXPECT_GT(full.fixedVertices, 20);
    options.evaluation.spectrum = Spectrum::Truncated;
    options.evaluation.truncation.basisSize = 400;
    options.evaluation.truncation.reinjectResidual = false;
    const Vertices truncated = fractionalFilter(mesh_.V, mesh_.F, options).V;
    EXPECT_LT(largestDifference(full.V, truncated), 1e-7);
}

INSTANTIATE_TEST_SUITE_P(Samples, OpenRealMesh, ::testing::Values("half_bunny"),
                         [](const auto& test) { return std::string(test.param); });

class RealOrBrokenMesh : public RealMesh {};

TEST_P(RealOrBrokenMesh, IntrinsicDelaunayWeightsAgreeWithRobustLaplacian) {
    const SparseMatrix ours = IntrinsicDelaunay(mesh_.V, mesh_.F).stiffness(mesh_.V);
    const SparseMatrix theirs = readStiffness(path_ + ".stiffness", mesh_.V.rows());
    ASSERT_GT(theirs.nonZeros(), 0);
    const SparseMatrix difference = ours - theirs;
    EXPECT_LT(difference.coeffs().cwiseAbs().maxCoeff(),
              1e-11 * theirs.coeffs().cwiseAbs().maxCoeff());
}

INSTANTIATE_TEST_SUITE_P(Samples, RealOrBrokenMesh,
                         ::testing::Values("bunny", "bone", "cow", "cow_with_fins", "half_bunny"),
                         [](const auto& test) { return std::string(test.param); });

INSTANTIATE_TEST_SUITE_P(Samples, RealMesh, ::testing::Values("bunny", "bone", "cow"),
                         [](const auto& test) { return std::string(test.param); });

}  // namespace
}  // namespace spectral
