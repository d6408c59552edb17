#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/analysis/manifold_harmonics.h"
#include "core/filter/fractional_filter.h"
#include "core/laplacian/constant_modes.h"
#include "core/laplacian/harmonic_extension.h"
#include "core/laplacian/interior.h"
#include "core/mesh/measures.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
#include "core/support/errors.h"
#include "core/transfer/transfer_function.h"
#include "support/evaluation.h"

namespace spectral {
namespace {

using testing::largestDifference;
using testing::Mesh;
using testing::Operator;

/// The part of a mesh that lies below a height: an open surface.
Mesh below(const Mesh& mesh, double height) {
    Faces F(mesh.F.rows(), 3);
    Index kept = 0;
    for (Index t = 0; t < mesh.F.rows(); ++t)
        if (mesh.V(mesh.F(t, 0), 2) < height && mesh.V(mesh.F(t, 1), 2) < height &&
            mesh.V(mesh.F(t, 2), 2) < height)
            F.row(kept++) = mesh.F.row(t);
    const Surface surface = surfaceOf(mesh.V, F.topRows(kept));
    return {surface.X, surface.F};
}

Mesh openBlob() { return below(testing::blob(), 0.9); }

Mesh triangle() {
    Mesh mesh{Vertices(3, 3), Faces(1, 3)};
    mesh.V << 3, 0, 0, 4, 0, 0, 3, 1, 0;
    mesh.F << 0, 1, 2;
    return mesh;
}

std::vector<Mesh> openMeshes() {
    return {openBlob(), testing::withNoise(testing::rectangle(2, 1, 20, 10), 0.03, 3),
            testing::joined(openBlob(), testing::torus(3, 0.8, 20, 10)),
            testing::joined(
                triangle(),
                testing::joined(testing::withNoise(testing::icosphere(2), 0.05, 5), openBlob()))};
}

const BasisUpdate kUpdates[] = {BasisUpdate::Full, BasisUpdate::Conformal, BasisUpdate::None};

FilterOptions smoothing(const Mesh& mesh, int steps, BasisUpdate update = BasisUpdate::Full) {
    FilterOptions options;
    options.featureSize = 0.25 * boundingBoxDiagonal(mesh.V);
    options.steps = steps;
    options.tolerance = 1e-3 * boundingBoxDiagonal(mesh.V);
    options.basisUpdate = update;
    options.boundary = Boundary::Fixed;
    options.evaluation.accuracy = 1e-9;
    return options;
}

TEST(BoundaryVertices, AreTheEndsOfEdgesOfOneTriangle) {
    const std::vector<bool> rim = boundaryVertices(testing::rectangle(1, 1, 6, 4).F, 35);
    EXPECT_EQ(std::count(rim.begin(), rim.end(), true), 2 * (6 + 4));
    const std::vector<bool> closed =
        boundaryVertices(testing::cube(3).F, testing::cube(3).V.rows());
    EXPECT_EQ(std::count(closed.begin(), closed.end(), true), 0);
}

TEST(BoundaryVertices, ExcludeTheEndsOfEdgesOfThreeTriangles) {
    Faces F(7, 3);  // two tetrahedra with the wall 0 1 2 between them
    F << 0, 1, 2, 0, 1, 3, 1, 2, 3, 2, 0, 3, 0, 1, 4, 1, 2, 4, 2, 0, 4;
    const std::vector<bool> none = boundaryVertices(F, 5);
    EXPECT_EQ(std::count(none.begin(), none.end(), true), 0);
    const Faces open = F.topRows(6);  // without 2 0 4
    const std::vector<bool> rim = boundaryVertices(open, 5);
    // The edge 2 0 keeps two triangles, 0 4 and 2 4 one.
    EXPECT_EQ(rim, (std::vector<bool>{true, false, true, false, true}));
}

TEST(Interior, HasConstantModesOfClosedComponentsOnly) {
    const Mesh mesh = testing::joined(testing::rectangle(1, 1, 3, 3), testing::icosphere(0));
    const Interior interior(mesh.F, connectedComponents(mesh.F, mesh.V.rows()), Boundary::Fixed);
    EXPECT_EQ(interior.size(), 4 + 12);
    EXPECT_EQ(interior.fixedVertices(), 12);
    EXPECT_EQ(interior.components().count, 1);
    EXPECT_TRUE((interior.components().label->head(4).array() == -1).all());
    EXPECT_TRUE((interior.components().label->tail(12).array() == 0).all());
}

/// Worst relative error of the 15 lowest eigenvalues pi^2 (p^2/a^2 + q^2/b^2), p, q >= 1.
double rectangleError(int cells) {
    const double a = 2.0, b = 1.0;
    const Mesh mesh = testing::rectangle(a, b, 2 * cells, cells);
    std::vector<double> exact;
    for (int p = 1; p < 12; ++p)
        for (int q = 1; q < 12; ++q)
            exact.push_back(kPi * kPi * (p * p / (a * a) + q * q / (b * b)));
    std::sort(exact.begin(), exact.end());
    HarmonicsOptions options;
    options.basisSize = 15;
    options.boundary = Boundary::Fixed;
    const Eigen::VectorXd lambda = manifoldHarmonics(mesh.V, mesh.F, options).lambda;
    double worst = 0.0;
    for (int i = 0; i < 15; ++i) worst = std::max(worst, std::abs(lambda[i] / exact[i] - 1.0));
    return worst;
}

TEST(FixedHarmonics, OfAFlatRectangleConvergeToTheDirichletEigenvaluesAtSecondOrder) {
    const double coarse = rectangleError(16), middle = rectangleError(32),
                 fine = rectangleError(64);
    EXPECT_LT(coarse, 0.06);
    EXPECT_NEAR(coarse / middle, 4.0, 0.2);
    EXPECT_NEAR(middle / fine, 4.0, 0.1);
}

TEST(FixedHarmonics, OfTheHemisphereAreTheSpheresOddOnes) {
    // l(l+1), with those l of its 2l+1 harmonics that vanish on the equator.
    const Mesh mesh = testing::hemisphere(24);
    HarmonicsOptions options;
    options.basisSize = 10;
    options.boundary = Boundary::Fixed;
    const Eigen::VectorXd lambda = manifoldHarmonics(mesh.V, mesh.F, options).lambda;
    Index i = 0;
    for (int l = 1; l <= 4; ++l)
        for (int copy = 0; copy < l; ++copy, ++i)
            EXPECT_NEAR(lambda[i] / (l * (l + 1.0)), 1.0, 0.01) << l;
}

TEST(FixedHarmonics, OfAClosedMeshAreTheFreeOnes) {
    const Mesh mesh = testing::blob();
    HarmonicsOptions options;
    options.basisSize = 20;
    const ManifoldHarmonics free = manifoldHarmonics(mesh.V, mesh.F, options);
    options.boundary = Boundary::Fixed;
    const ManifoldHarmonics fixed = manifoldHarmonics(mesh.V, mesh.F, options);
    EXPECT_TRUE(free.Phi == fixed.Phi);
    EXPECT_TRUE(free.lambda == fixed.lambda);
}

TEST(FixedHarmonics, ASizeThatTheInteriorCannotHoldIsRefused) {
    const Mesh mesh = testing::rectangle(1, 1, 4, 4);  // nine vertices inside
    HarmonicsOptions options;
    options.boundary = Boundary::Fixed;
    options.basisSize = 8;
    EXPECT_EQ(manifoldHarmonics(mesh.V, mesh.F, options).lambda.size(), 8);
    for (const int size : {9, 0, -1}) {
        options.basisSize = size;
        EXPECT_THROW(manifoldHarmonics(mesh.V, mesh.F, options), InvalidOption) << size;
    }
    options.basisSize = 1;
    EXPECT_THROW(manifoldHarmonics(triangle().V, triangle().F, options), InvalidOption);
}

TEST(HarmonicExtension, ReproducesALinearFunctionOnAFlatMesh) {
    Mesh flat = testing::withNoise(testing::rectangle(2, 1, 20, 10), 0.03, 3);
    flat.V.col(2).setZero();
    const Operator A(flat);
    const Interior interior(flat.F, connectedComponents(flat.F, flat.V.rows()), Boundary::Fixed);
    const HarmonicExtension::Remainder remainder =
        HarmonicExtension(interior).remainder(A, interior.restricted(A), flat.V);
    EXPECT_LT(remainder.U.cwiseAbs().maxCoeff(), 1e-14);
    EXPECT_LT(remainder.relativeSize, 1e-14);
}

TEST(FixedBoundary, StaysBitIdentical) {
    for (const Mesh& mesh : openMeshes())
        for (const BasisUpdate update : kUpdates)
            for (const Spectrum spectrum : {Spectrum::Full, Spectrum::Truncated})
                for (const int steps : {0, 3}) {
                    FilterOptions options = smoothing(mesh, steps, update);
                    options.tolerance = 0.02 * boundingBoxDiagonal(mesh.V);
                    options.evaluation.spectrum = spectrum;
                    options.evaluation.truncation.basisSize = 30;
                    const FilterResult result = fractionalFilter(mesh.V, mesh.F, options);
                    const std::vector<bool> rim = boundaryVertices(mesh.F, mesh.V.rows());
                    for (Index i = 0; i < mesh.V.rows(); ++i)
                        EXPECT_TRUE(!rim[i] || result.V.row(i) == mesh.V.row(i));
                    EXPECT_EQ(result.fixedVertices, std::count(rim.begin(), rim.end(), true));
                    EXPECT_GT(result.maxDisplacement, 1e-3 * boundingBoxDiagonal(mesh.V));
                }
}

TEST(FixedBoundary, WithUnitGainNothingMoves) {
    for (const Mesh& mesh : openMeshes())
        for (const BasisUpdate update : kUpdates)
            for (const Spectrum spectrum : {Spectrum::Full, Spectrum::Truncated}) {
                FilterOptions options = smoothing(mesh, 3, update);
                options.transferFunction.stopGain = 1.0;
                options.evaluation.spectrum = spectrum;
                options.evaluation.truncation.basisSize = 30;
                EXPECT_LT(fractionalFilter(mesh.V, mesh.F, options).maxDisplacement,
                          1e-12 * boundingBoxDiagonal(mesh.V));
            }
}

TEST(FixedBoundary, KeepsAFlatPatchThatShrinksWithAFreeBoundary) {
    Mesh flat = testing::withNoise(testing::rectangle(2, 1, 20, 10), 0.02, 3);
    flat.V.col(2).setZero();
    FilterOptions options = smoothing(flat, 4);
    EXPECT_LT(fractionalFilter(flat.V, flat.F, options).maxDisplacement, 1e-12);
    options.boundary = Boundary::Free;
    EXPECT_GT(fractionalFilter(flat.V, flat.F, options).maxDisplacement, 1e-3);
}

TEST(FixedBoundary, ChangesNothingOnAClosedMesh) {
    for (const Mesh& mesh : {testing::blob(), testing::joined(testing::cube(5), testing::blob())})
        for (const int steps : {0, 2}) {
            FilterOptions options = smoothing(mesh, steps, BasisUpdate::Conformal);
            const FilterResult fixed = fractionalFilter(mesh.V, mesh.F, options);
            options.boundary = Boundary::Free;
            const FilterResult free = fractionalFilter(mesh.V, mesh.F, options);
            EXPECT_TRUE(fixed.V == free.V);
            EXPECT_EQ(fixed.fixedVertices, 0);
            EXPECT_EQ(fixed.factorizations, free.factorizations);
        }
}

TEST(FixedBoundary, FiltersEveryComponentAsIfItWereAlone) {
    const Mesh closed = testing::torus(3, 0.8, 20, 10), open = openBlob();
    const Mesh both = testing::joined(closed, open);
    for (const BasisUpdate update : kUpdates) {
        FilterOptions options = smoothing(open, 3, update);
        const Vertices together = fractionalFilter(both.V, both.F, options).V;
        const Vertices openAlone = fractionalFilter(open.V, open.F, options).V;
        options.boundary = Boundary::Free;
        const Vertices closedAlone = fractionalFilter(closed.V, closed.F, options).V;
        EXPECT_LT(largestDifference(together.topRows(closed.V.rows()), closedAlone), 1e-7);
        EXPECT_LT(largestDifference(together.bottomRows(open.V.rows()), openAlone), 1e-7);
    }
}

TEST(FixedBoundary, ABasisThatTheInteriorCannotHoldIsRefused) {
    const Mesh mesh = testing::rectangle(1, 1, 4, 4);  // nine vertices inside
    FilterOptions options = smoothing(mesh, 1);
    options.evaluation.spectrum = Spectrum::Truncated;
    options.evaluation.truncation.basisSize = 9;
    try {
        fractionalFilter(mesh.V, mesh.F, options);
        FAIL() << "accepted";
    } catch (const InvalidOption& error) {
        EXPECT_EQ(error.code(), ErrorCode::BasisTooLarge);
        EXPECT_EQ(error.limit(), 8);
        EXPECT_NE(std::string(error.what()).find("fixed boundary"), std::string::npos);
    }
}

TEST(FixedBoundary, AutomaticStepsReachTheLimitOfManySteps) {
    const Mesh mesh = openBlob();
    FilterOptions options = smoothing(mesh, 0);
    const FilterResult automatic = fractionalFilter(mesh.V, mesh.F, options);
    EXPECT_TRUE(automatic.toleranceReached);
    options.tolerance /= 50.0;
    const FilterResult finer = fractionalFilter(mesh.V, mesh.F, options);
    EXPECT_TRUE(finer.toleranceReached);
    EXPECT_GT(finer.steps, automatic.steps);
    EXPECT_LT(largestDifference(automatic.V, finer.V), 50.0 * options.tolerance);
}

}  // namespace
}  // namespace spectral
