#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/krylov/chebyshev_series.h"
#include "core/krylov/full_spectrum.h"
#include "core/krylov/krylov_operator.h"
#include "core/laplacian/interior.h"
#include "core/laplacian/laplacian_builder.h"
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
    for (const Mesh& mesh : {testing::withNoise(testing::cube(8), 0.02, 4),
                             testing::withNoise(testing::rectangle(2, 1, 24, 12), 0.03, 3),
                             testing::joined(testing::withNoise(testing::icosphere(2), 0.05, 5),
                                             testing::torus(2, 0.7, 16, 8))}) {
        const Operator A(mesh);
        const HarmonicBasis dense = denseBasis(A);
        for (const auto& transfer : testing::smoothTransferFunctions())
            for (const double alpha : {1.0, 0.1}) {
                const TransferFunction F(transfer, 2.0 * kPi / 0.5);
                const Vertices expected =
                    testing::filteredDense(A, dense, fractionalPower(F, alpha));
                for (const double accuracy : {1e-4, 1e-9})
                    for (const bool atEveryVertex : {false, true}) {
                        FullSpectrumOptions options;
                        options.accuracy = accuracy;
                        options.atEveryVertex = atEveryVertex;
                        options.samples = F.samples();
                        const FullSpectrumResult result = byProducts(A, F, alpha, options).front();
                        const Vertices error = result.Y - expected;
                        const Eigen::VectorXd& D = A.D;
                        Vertices X = A.mesh.V;
                        A.constants.remove(A.D, X);
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
}

TEST(Products, HaveNoEigenvalueAboveTheirBound) {
    // A sliver, whose weights are far above those of its neighbours; and obtuse angles, with
    // weights below 0.
    Mesh sliver = testing::cube(4);
    sliver.V.row(0) = 0.999 * sliver.V.row(1) + 0.001 * sliver.V.row(0);
    for (const Mesh& mesh : {testing::blob(), sliver, testing::rectangle(8, 1, 6, 9)})
        for (const LaplacianKind kind :
             {LaplacianKind::IntrinsicDelaunay, LaplacianKind::Cotangent}) {
            const Surface surface = surfaceOf(mesh.V, mesh.F);
            const Components components = connectedComponents(surface.F, surface.X.rows());
            const LaplacianBuilder laplacians(surface, components, kind, BasisUpdate::None);
            const Interior fixed(surface.F, components, Boundary::Fixed);
            const Laplacian inside = fixed.restricted(laplacians.current());
            for (const Laplacian& A : {laplacians.current(), inside}) {
                const Eigen::VectorXd root = A.D.cwiseSqrt().cwiseInverse();
                const double largest =
                    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(
                        root.asDiagonal() * Eigen::MatrixXd(A.W) * root.asDiagonal())
                        .eigenvalues()
                        .maxCoeff();
                const double bound = std::pow(Products(A, 1.0).lastFrequency(), 2);
                EXPECT_GE(bound, largest * (1.0 - 1e-12));
                EXPECT_LE(bound, 3.0 * largest);
            }
        }
}

TEST(Products, InSinglePrecisionAreAsAccurateAsTheyClaim) {
    // A small displacement of a large shape, in any unit: its rounding is relative to what moves.
    for (const double scale : {1e-30, 1.0, 1e30}) {
        Mesh mesh = testing::withNoise(testing::icosphere(3), 1e-3, 4);
        mesh.V *= scale;
        const Operator A(mesh);
        const HarmonicBasis dense = denseBasis(A);
        for (const double size : {0.05, 0.5}) {
            const TransferFunction F({}, 2.0 * kPi / (size * scale));
            FullSpectrumOptions options;
            options.atEveryVertex = false;
            options.samples = F.samples();
            for (const double accuracy : {1e-4, 1e-5, 1e-6, 1e-7}) {
                options.accuracy = accuracy;
                const FullSpectrumResult result = byProducts(A, F, 1.0, options).front();
                const Vertices error =
                    (result.Y - testing::filteredDense(A, dense, fractionalPower(F, 1.0))) / scale;
                const double relative =
                    std::sqrt(A.D.dot(error.rowwise().squaredNorm()) / A.D.sum());
                EXPECT_TRUE(result.converged);
                EXPECT_LE(relative, accuracy) << "size " << size << ", scale " << scale;
                EXPECT_LE(relative, result.errorEstimate);
            }
        }
    }
}

TEST(ChebyshevSeries, OfAPolynomialEndsAtItsDegree) {
    // T_3(x) = 4 x^3 - 3 x, with x = t - 1 on [0, 2].
    const ChebyshevSeries series(
        [](double t) { return 4.0 * std::pow(t - 1.0, 3) - 3.0 * (t - 1.0); }, 0.0, 2.0, 16);
    EXPECT_EQ(series.lengthFor(1e-12), 4);
    for (int k = 0; k < 16; ++k) EXPECT_NEAR(series.coefficients()[k], k == 3 ? 1.0 : 0.0, 1e-14);
    EXPECT_NEAR(series(0.5), 1.0, 1e-14);  // cos(3 arccos(-1/2))
}

TEST(ChebyshevSeries, IsBoundedByItsTail) {
    const auto f = [](double t) { return std::exp(-7.0 * t); };
    const ChebyshevSeries series(f, 0.0, 1.0, 32);
    for (const double accuracy : {1e-2, 1e-5, 1e-9}) {
        const auto length = static_cast<std::size_t>(series.lengthFor(accuracy));
        EXPECT_LE(series.tail(length), accuracy);
        EXPECT_GT(series.tail(length - 1), accuracy);
        for (double t = 0.0; t <= 1.0; t += 0.01) {
            double sum = 0.0;
            for (std::size_t k = 0; k < length; ++k)
                sum += series.coefficients()[k] *
                       std::cos(static_cast<double>(k) * std::acos(2.0 * t - 1.0));
            EXPECT_LE(std::abs(sum - f(t)), accuracy);
        }
    }
}

TEST(LaplacianBuilder, BoundsTheEigenvaluesOfSlivers) {
    // A point beside a side of a triangle, and another one between that and the side.
    Mesh mesh = testing::cube(6);
    const int p = static_cast<int>(mesh.V.rows()), q = p + 1;
    const int a = mesh.F(0, 0), b = mesh.F(0, 1), c = mesh.F(0, 2);
    mesh.V.conservativeResize(q + 1, 3);
    mesh.V.row(p) = 0.49 * mesh.V.row(a) + 0.49 * mesh.V.row(b) + 0.02 * mesh.V.row(c);
    mesh.V.row(q) = 0.495 * mesh.V.row(a) + 0.495 * mesh.V.row(b) + 0.01 * mesh.V.row(c);
    Faces split(5, 3);
    split << b, c, p, c, a, p, a, b, q, b, p, q, p, a, q;
    mesh.F.conservativeResize(mesh.F.rows() + 4, 3);
    mesh.F.row(0) = split.row(0);
    mesh.F.bottomRows(4) = split.bottomRows(4);
    const Surface surface = surfaceOf(mesh.V, mesh.F);
    const Components components = connectedComponents(surface.F, surface.X.rows());
    const MeshLaplacian input = meshLaplacian(surface, LaplacianKind::IntrinsicDelaunay);
    const auto& [W, D, constants] = input.laplacian;
    const Eigen::VectorXd local = 2.0 * W.diagonal().cwiseQuotient(D);
    Eigen::VectorXd sorted = local;
    std::sort(sorted.begin(), sorted.end());
    // The masses around a vertex limit the first one's factors, 2 W_ii / D_ii those of the other.
    for (const double largest : {1.01 * sorted[sorted.size() * 9 / 10], 0.7 * sorted.maxCoeff()}) {
        ASSERT_LT(largest, sorted.maxCoeff());
        LaplacianBuilder laplacians(surface, components, LaplacianKind::IntrinsicDelaunay,
                                    BasisUpdate::Conformal);
        laplacians.boundEigenvalues(largest);
        const Eigen::VectorXd factor = laplacians.current().D.cwiseQuotient(D);
        EXPECT_GT(factor.maxCoeff(), 1.4);
        for (Index i = 0; i < D.size(); ++i) {
            double sum = 0.0, count = 0.0;
            for (SparseMatrix::InnerIterator entry(W, i); entry; ++entry, count += 1.0)
                sum += D[entry.row()];
            const double most = std::max(1.0, 0.25 * sum / count / D[i]);
            EXPECT_NEAR(factor[i], std::clamp(local[i] / largest, 1.0, most), 1e-12) << i;
        }
        // What shrinks does so with its mass.
        laplacians.update(0.1 * surface.X);
        EXPECT_TRUE(laplacians.current().D.isApprox(0.01 * factor.cwiseProduct(D), 1e-12));
    }
}

TEST(LaplacianBuilder, KeepsTheMassesOfARegionOfNeedles) {
    Mesh mesh = testing::icosphere(3);
    mesh.V.col(2) *= 100.0;  // 100 times as long as wide
    const Surface surface = surfaceOf(mesh.V, mesh.F);
    LaplacianBuilder laplacians(surface, connectedComponents(surface.F, surface.X.rows()),
                                LaplacianKind::IntrinsicDelaunay, BasisUpdate::Conformal);
    const double area = laplacians.current().D.sum();
    laplacians.boundEigenvalues(1e-3);
    EXPECT_LT(laplacians.current().D.sum(), 1.02 * area);
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
