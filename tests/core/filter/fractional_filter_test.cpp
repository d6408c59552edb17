#include "core/filter/fractional_filter.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "core/laplacian/constant_modes.h"
#include "core/laplacian/interior.h"
#include "core/laplacian/laplacian.h"
#include "core/mesh/measures.h"
#include "core/mesh/mesh.h"
#include "core/support/threads.h"
#include "core/transfer/transfer_function.h"
#include "support/evaluation.h"

namespace spectral {
namespace {

using testing::classesOfMeshes;
using testing::largestDifference;
using testing::Mesh;
using testing::Operator;

/// A boost of medium details in three steps, which every kind of mesh survives.
FilterOptions boost(const Mesh& mesh, BasisUpdate update = BasisUpdate::Full) {
    FilterOptions options;
    options.transferFunction.type = FilterType::BandPass;
    options.transferFunction.stopGain = 1.0;
    options.transferFunction.passGain = 1.8;
    options.featureSize = 0.3 * boundingBoxDiagonal(mesh.V);
    options.steps = 3;
    options.basisUpdate = update;
    options.evaluation.accuracy = 1e-9;
    return options;
}

FilterOptions smoothing(const Mesh& mesh, int steps, BasisUpdate update) {
    FilterOptions options;
    options.featureSize = 0.25 * boundingBoxDiagonal(mesh.V);
    options.steps = steps;
    options.basisUpdate = update;
    options.evaluation.accuracy = 1e-9;
    return options;
}

const BasisUpdate kUpdates[] = {BasisUpdate::Full, BasisUpdate::Conformal, BasisUpdate::None};

TEST(FractionalFilter, WithUnitGainMovesNothing) {
    for (const Mesh& mesh : classesOfMeshes())
        for (const BasisUpdate update : kUpdates)
            for (const Spectrum spectrum : {Spectrum::Full, Spectrum::Truncated}) {
                FilterOptions options = smoothing(mesh, 3, update);
                options.transferFunction.stopGain = 1.0;
                options.evaluation.spectrum = spectrum;
                options.evaluation.truncation.basisSize = 40;
                const FilterResult result = fractionalFilter(mesh.V, mesh.F, options);
                EXPECT_LT(result.maxDisplacement, 1e-12 * boundingBoxDiagonal(mesh.V));
            }
}

TEST(FractionalFilter, InManyStepsWithoutUpdateEqualsOneStep) {
    for (const Mesh& mesh : classesOfMeshes())
        for (const Spectrum spectrum : {Spectrum::Full, Spectrum::Truncated}) {
            FilterOptions options = smoothing(mesh, 1, BasisUpdate::None);
            options.evaluation.spectrum = spectrum;
            options.evaluation.truncation.basisSize = 40;
            const Vertices once = fractionalFilter(mesh.V, mesh.F, options).V;
            options.steps = 7;
            const Vertices often = fractionalFilter(mesh.V, mesh.F, options).V;
            EXPECT_LT(largestDifference(once, often), 1e-7 * boundingBoxDiagonal(mesh.V));
        }
}

TEST(FractionalFilter, IsBitIdenticalForEveryNumberOfThreads) {
    // Large enough for several subtrees of the factorization and several blocks of rows; one mesh
    // of two components, one with a fixed boundary.
    const Mesh closed = testing::joined(testing::icosphere(5), testing::cube(20));
    const Mesh sheet = testing::withNoise(testing::rectangle(2, 1, 120, 60), 0.01, 3);
    for (const Boundary boundary : {Boundary::Free, Boundary::Fixed})
        for (const BasisUpdate update : {BasisUpdate::Full, BasisUpdate::Conformal})
            for (const int steps : {0, 2}) {
                const Mesh& mesh = boundary == Boundary::Free ? closed : sheet;
                FilterOptions options = smoothing(mesh, steps, update);
                options.featureSize = 0.1 * boundingBoxDiagonal(mesh.V);
                options.tolerance = 1e-3;
                options.boundary = boundary;
                std::vector<Vertices> results;
                for (const int threads : {1, 2, 3}) {
                    setThreadCount(threads);
                    results.push_back(fractionalFilter(mesh.V, mesh.F, options).V);
                }
                setThreadCount(0);
                EXPECT_TRUE(results[0] == results[1]);
                EXPECT_TRUE(results[0] == results[2]);
            }
}

TEST(FractionalFilter, NeedsNoOptionButTheFeatureSize) {
    const Mesh mesh = testing::blob();
    FilterOptions options;
    options.featureSize = 0.2 * boundingBoxDiagonal(mesh.V);
    const Vertices result = fractionalFilter(mesh.V, mesh.F, options).V;
    options.tolerance = 0.0005 * boundingBoxDiagonal(mesh.V);
    EXPECT_TRUE(result == fractionalFilter(mesh.V, mesh.F, options).V);
}

TEST(FractionalFilter, CommutesWithRigidMotions) {
    const Eigen::Matrix3d rotation =
        Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -0.5).normalized()).toRotationMatrix();
    for (const Mesh& mesh : classesOfMeshes())
        for (const BasisUpdate update : kUpdates) {
            const FilterOptions options = boost(mesh, update);
            const Vertices moved = (mesh.V * rotation).rowwise() + Eigen::RowVector3d(5, -3, 2);
            const Vertices expected =
                (fractionalFilter(mesh.V, mesh.F, options).V * rotation).rowwise() +
                Eigen::RowVector3d(5, -3, 2);
            EXPECT_LT(largestDifference(fractionalFilter(moved, mesh.F, options).V, expected),
                      1e-7 * boundingBoxDiagonal(mesh.V));
        }
}

TEST(FractionalFilter, CommutesWithUniformScale) {
    for (const Mesh& mesh : classesOfMeshes())
        for (const double scale : {1e-6, 1e5}) {
            FilterOptions options = boost(mesh);
            const Vertices expected = scale * fractionalFilter(mesh.V, mesh.F, options).V;
            options.featureSize *= scale;
            const Vertices scaled = fractionalFilter(scale * mesh.V, mesh.F, options).V;
            EXPECT_LT(largestDifference(scaled, expected),
                      1e-8 * scale * boundingBoxDiagonal(mesh.V));
        }
}

TEST(FractionalFilter, CommutesWithAPermutationOfTheVertices) {
    const Mesh mesh = testing::blob();
    const Index n = mesh.V.rows();
    Mesh reversed = mesh;
    reversed.V = mesh.V.colwise().reverse();
    reversed.F = (n - 1 - mesh.F.array()).matrix();
    const FilterOptions options = boost(mesh);
    const Vertices expected = fractionalFilter(mesh.V, mesh.F, options).V.colwise().reverse();
    EXPECT_LT(largestDifference(fractionalFilter(reversed.V, reversed.F, options).V, expected),
              1e-8);
}

TEST(FractionalFilter, GivesTheSameShapeAMillionUnitsFromTheOrigin) {
    const Mesh mesh = testing::blob();
    const Eigen::RowVector3d away(1e6, -1e6, 1e6);
    const FilterOptions options = boost(mesh);
    const Vertices far =
        fractionalFilter(mesh.V.rowwise() + away, mesh.F, options).V.rowwise() - away;
    // The input itself is rounded to 1e-10 there.
    EXPECT_LT(largestDifference(far, fractionalFilter(mesh.V, mesh.F, options).V), 1e-7);
}

TEST(FractionalFilter, KeepsTheCentroidOfEveryComponent) {
    const Mesh mesh = testing::joined(testing::blob(), testing::torus(3, 0.8, 24, 12));
    const Operator A(mesh);
    for (const FilterType type : {FilterType::LowPass, FilterType::HighPass}) {
        FilterOptions options = smoothing(mesh, 1, BasisUpdate::Full);
        options.transferFunction.type = type;
        const Vertices Y = fractionalFilter(mesh.V, mesh.F, options).V;
        EXPECT_LT(
            (A.constants.means(A.D, Y) - A.constants.means(A.D, mesh.V)).cwiseAbs().maxCoeff(),
            1e-13);
    }
}

TEST(FractionalFilter, WithAPowerIsAnIntermediateShape) {
    // Three steps of F^(1/5), then the other two; with a truncated basis also of the residual.
    const Mesh mesh = testing::blob();
    for (const Spectrum spectrum : {Spectrum::Full, Spectrum::Truncated}) {
        FilterOptions options = boost(mesh);
        options.evaluation.spectrum = spectrum;
        options.evaluation.truncation.basisSize = 20;
        options.steps = 5;
        const Vertices whole = fractionalFilter(mesh.V, mesh.F, options).V;
        options.steps = 3;
        options.transferFunction.power = 0.6;
        const Vertices onTheWay = fractionalFilter(mesh.V, mesh.F, options).V;
        options.steps = 2;
        options.transferFunction.power = 0.4;
        const Vertices end = fractionalFilter(onTheWay, mesh.F, options).V;
        EXPECT_LT(largestDifference(end, whole), 1e-7 * boundingBoxDiagonal(mesh.V));
        EXPECT_GT(largestDifference(onTheWay, whole), 1e-3 * boundingBoxDiagonal(mesh.V));
    }
}

TEST(FractionalFilter, LowPassLowersTheDirichletEnergy) {
    for (const Mesh& mesh : classesOfMeshes()) {
        FilterOptions options = smoothing(mesh, 1, BasisUpdate::None);
        options.laplacian = LaplacianKind::Cotangent;
        const SparseMatrix W = testing::cotangentLaplacian(mesh.V, mesh.F).W;
        const Vertices Y = fractionalFilter(mesh.V, mesh.F, options).V;
        EXPECT_LT((Y.transpose() * W * Y).trace(), (mesh.V.transpose() * W * mesh.V).trace());
    }
}

TEST(FractionalFilter, LeavesUnreferencedVerticesAlone) {
    const Mesh mesh = testing::blob();
    Vertices V(mesh.V.rows() + 2, 3);
    V << Eigen::RowVector3d(9, 9, 9), mesh.V, Eigen::RowVector3d(-50, 0, 0);
    const Faces F = (mesh.F.array() + 1).matrix();
    const FilterOptions options = boost(mesh);
    const FilterResult result = fractionalFilter(V, F, options);
    EXPECT_EQ(result.unreferencedVertices, 2);
    EXPECT_EQ(result.V.row(0), V.row(0));
    EXPECT_EQ(result.V.row(V.rows() - 1), V.row(V.rows() - 1));
    const Vertices alone = fractionalFilter(mesh.V, mesh.F, options).V;
    EXPECT_LT(largestDifference(result.V.middleRows(1, mesh.V.rows()), alone), 1e-12);
}

TEST(FractionalFilter, InAutomaticStepsDoesNotMistakeACollapseForConvergence) {
    // The half step of this high-pass shrinks the tetrahedron to 1e-8 of its size, where all of
    // its frequencies pass.
    Mesh mesh{Vertices(4, 3), Faces(4, 3)};
    mesh.V << 1, 1, 1, 1, -1, -1, -1, 1, -1, -1, -1, 1;
    mesh.F << 0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2;
    FilterOptions options;
    options.transferFunction.type = FilterType::HighPass;
    options.featureSize = 0.5;
    options.tolerance = 1e-3;
    const FilterResult result = fractionalFilter(mesh.V, mesh.F, options);
    EXPECT_LT(result.areaAfter, 0.1 * result.areaBefore);
}

TEST(FractionalFilter, ConformalShareInterpolatesBetweenFullAndConformalUpdate) {
    const Mesh mesh = testing::blob();
    FilterOptions options = smoothing(mesh, 5, BasisUpdate::Full);
    const Vertices full = fractionalFilter(mesh.V, mesh.F, options).V;
    options.conformalShare = 1.0;
    const Vertices all = fractionalFilter(mesh.V, mesh.F, options).V;
    options.conformalShare = 0.5;
    const Vertices half = fractionalFilter(mesh.V, mesh.F, options).V;
    const Vertices conformal =
        fractionalFilter(mesh.V, mesh.F, smoothing(mesh, 5, BasisUpdate::Conformal)).V;

    EXPECT_LE(largestDifference(all, conformal), 1e-8);
    const double whole = largestDifference(full, conformal);
    EXPECT_GT(whole, 1e-4);
    EXPECT_LT(largestDifference(full, half), 0.75 * whole);
    EXPECT_LT(largestDifference(half, conformal), 0.75 * whole);
}

TEST(FractionalFilter, OfATruncatedSpectrumDoesNotDependOnTheScale) {
    const Mesh mesh = testing::blob();
    FilterOptions options;
    options.evaluation.spectrum = Spectrum::Truncated;
    options.evaluation.truncation.basisSize = 60;
    options.steps = 1;
    options.featureSize = 0.6;
    const Vertices expected = fractionalFilter(mesh.V, mesh.F, options).V;
    for (const double scale : {1e10, 1e-10}) {
        options.featureSize = 0.6 * scale;
        const Vertices V = fractionalFilter(mesh.V * scale, mesh.F, options).V / scale;
        EXPECT_LT(largestDifference(V, expected), 1e-8) << scale;
    }
}

TEST(FractionalFilter, KeepsNegativeZerosOfFixedVertices) {
    Mesh mesh = testing::withNoise(testing::rectangle(1, 1, 6, 6), 0.01, 3);
    mesh.V.row(0).setConstant(-0.0);  // a corner
    FilterOptions options;
    options.boundary = Boundary::Fixed;
    options.steps = 1;
    options.featureSize = 0.5;
    const FilterResult result = fractionalFilter(mesh.V, mesh.F, options);
    EXPECT_GT(result.maxDisplacement, 0.0);
    for (int c = 0; c < 3; ++c) EXPECT_TRUE(std::signbit(result.V(0, c)));
}

}  // namespace
}  // namespace spectral
