#include "core/mesh/seams.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <random>
#include <utility>

#include "core/analysis/artefacts.h"
#include "core/analysis/geometry_spectrum.h"
#include "core/analysis/manifold_harmonics.h"
#include "core/denoise/denoise.h"
#include "core/filter/fractional_filter.h"
#include "core/filter/signal_filter.h"
#include "core/mesh/measures.h"
#include "core/mesh/surface.h"
#include "support/noisy_shapes.h"

namespace spectral {
namespace {

using testing::joined;
using testing::Mesh;

/// A mesh cut apart, and the original of each of its vertices.
struct CutMesh {
    Mesh mesh;
    std::vector<Index> origin;

    Eigen::MatrixXd cut(const Eigen::MatrixXd& values) const {
        return values(origin, Eigen::indexing::all);
    }
};

/// Cuts a mesh between triangles of different charts: corners at a vertex stay joined within a
/// chart.
/// @param chart  chart of each triangle.
CutMesh cutApart(const Mesh& mesh, const std::vector<int>& chart) {
    CutMesh cut;
    cut.mesh.F.resize(mesh.F.rows(), 3);
    std::map<std::pair<int, int>, int> number;
    for (Index t = 0; t < mesh.F.rows(); ++t)
        for (int c = 0; c < 3; ++c) {
            const int i = mesh.F(t, c);
            const auto [at, isNew] =
                number.try_emplace({i, chart[t]}, static_cast<int>(number.size()));
            if (isNew) cut.origin.push_back(i);
            cut.mesh.F(t, c) = at->second;
        }
    cut.mesh.V = mesh.V(cut.origin, Eigen::indexing::all);
    return cut;
}

/// Every triangle on its own, as in an STL file.
CutMesh soupOf(const Mesh& mesh) {
    std::vector<int> chart;
    for (int t = 0; t < mesh.F.rows(); ++t) chart.push_back(t);
    return cutApart(mesh, chart);
}

/// Eight islands as in a texture atlas, one for each octant, by the centres of the triangles.
CutMesh islandsOf(const Mesh& mesh) {
    std::vector<int> chart;
    for (Index t = 0; t < mesh.F.rows(); ++t) {
        const Eigen::RowVector3d centre =
            mesh.V.row(mesh.F(t, 0)) + mesh.V.row(mesh.F(t, 1)) + mesh.V.row(mesh.F(t, 2));
        chart.push_back((centre[0] > 0.0) + 2 * (centre[1] > 0.0) + 4 * (centre[2] > 0.0));
    }
    return cutApart(mesh, chart);
}

/// Automatic steps sum up displacements, a few hundredths of the diagonal here, in single
/// precision.
constexpr double kSinglePrecision = 6e-8 * 0.05;

constexpr LaplacianKind kKinds[] = {LaplacianKind::IntrinsicDelaunay, LaplacianKind::Cotangent,
                                    LaplacianKind::Uniform};

Mesh noisyBlob() { return testing::withGaussianNoise(testing::blob(), 0.1, 7); }

class CutSurface : public ::testing::TestWithParam<CutMesh (*)(const Mesh&)> {
  protected:
    const Mesh whole = noisyBlob();
    const CutMesh cut = GetParam()(whole);
    const double diagonal = boundingBoxDiagonal(whole.V);

    void expectEqual(const Eigen::MatrixXd& cutValues, const Eigen::MatrixXd& wholeValues,
                     double tolerance) const {
        EXPECT_LE((cutValues - cut.cut(wholeValues)).cwiseAbs().maxCoeff(), tolerance);
    }
};

TEST_P(CutSurface, BecomesTheWholeSurface) {
    const Surface surface = joinedSurface(cut.mesh.V, cut.mesh.F);
    EXPECT_EQ(surface.X.rows(), whole.V.rows());
    EXPECT_EQ(connectedComponents(surface.F, surface.X.rows()).count, 1);
    EXPECT_EQ(surface.nearlyCopies, 0);
    const SurfaceCounts counts = countsOf(surface, cut.mesh.V.rows(), 1, 0);
    EXPECT_EQ(counts.joinedVertices, cut.mesh.V.rows() - whole.V.rows());
    EXPECT_EQ(counts.unreferencedVertices, 0);
}

TEST_P(CutSurface, IsFilteredLikeTheWhole) {
    for (const LaplacianKind kind :
         {LaplacianKind::IntrinsicDelaunay, LaplacianKind::Cotangent, LaplacianKind::Uniform})
        for (const int steps : {0, 3}) {
            FilterOptions options;
            options.featureSize = 0.1 * diagonal;
            options.tolerance = 0.0005 * diagonal;
            options.laplacian = kind;
            options.steps = steps;
            options.preserveVolume = true;
            options.basisUpdate = steps == 0 ? BasisUpdate::Conformal : BasisUpdate::Full;
            const FilterResult result = fractionalFilter(cut.mesh.V, cut.mesh.F, options);
            expectEqual(result.V, fractionalFilter(whole.V, whole.F, options).V,
                        (steps == 0 ? kSinglePrecision : 1e-12) * diagonal);
            EXPECT_EQ(result.joinedVertices, cut.mesh.V.rows() - whole.V.rows());
            EXPECT_EQ(result.volumes.preserved, 1);
        }
}

TEST_P(CutSurface, IsPartlyFilteredLikeTheWhole) {
    FilterOptions options;
    options.featureSize = 0.1 * diagonal;
    options.tolerance = 0.0005 * diagonal;
    options.part.weight = (whole.V.col(0).array() / diagonal + 0.5).matrix();
    std::vector<bool> selected;
    for (Index i = 0; i < whole.V.rows(); ++i) selected.push_back(whole.V(i, 1) > 0.2);
    options.part.selected = selected;
    const Vertices expected = fractionalFilter(whole.V, whole.F, options).V;
    options.part.weight = cut.cut(options.part.weight);
    options.part.selected.clear();
    for (const Index i : cut.origin) options.part.selected.push_back(selected[i]);
    expectEqual(fractionalFilter(cut.mesh.V, cut.mesh.F, options).V, expected,
                kSinglePrecision * diagonal);
}

TEST_P(CutSurface, IsDenoisedLikeTheWhole) {
    const Mesh noisy = testing::withGaussianNoise(testing::icosphere(4), 0.2, 3);
    const CutMesh cutNoisy = GetParam()(noisy);
    const DenoiseResult result = denoise(cutNoisy.mesh.V, cutNoisy.mesh.F, {});
    const DenoiseResult expected = denoise(noisy.V, noisy.F, {});
    EXPECT_GT(result.maxDisplacement, 0.0);
    EXPECT_EQ(result.diagnosis.kind, expected.diagnosis.kind);
    EXPECT_LE(testing::largestDifference(result.V, cutNoisy.cut(expected.V)), 1e-12 * 2.0);
}

TEST_P(CutSurface, HasTheSignalsOfTheWhole) {
    SignalFilterOptions options;
    options.featureSize = 0.1 * diagonal;
    const Eigen::MatrixXd Q = whole.V.leftCols(2);
    for (const LaplacianKind kind : kKinds) {
        options.laplacian = kind;
        expectEqual(filterSignal(cut.mesh.V, cut.mesh.F, cut.cut(Q), options).Y,
                    filterSignal(whole.V, whole.F, Q, options).Y, 1e-12 * diagonal);
    }
}

TEST_P(CutSurface, HasTheHarmonicsOfTheWhole) {
    HarmonicsOptions options;
    options.basisSize = 20;
    for (const LaplacianKind kind : kKinds) {
        options.laplacian = kind;
        const ManifoldHarmonics result = manifoldHarmonics(cut.mesh.V, cut.mesh.F, options);
        const ManifoldHarmonics expected = manifoldHarmonics(whole.V, whole.F, options);
        EXPECT_LE((result.lambda - expected.lambda).cwiseAbs().maxCoeff(),
                  1e-9 * expected.lambda.maxCoeff());
        if (kind !=
            LaplacianKind::Uniform)  // whose connections are symmetric: multiple eigenvalues
            expectEqual(result.Phi.cwiseAbs(), expected.Phi.cwiseAbs(), 1e-7);
    }
}

TEST_P(CutSurface, HasTheArtefactsAndTheSpectrumOfTheWhole) {
    ArtefactOptions options;
    options.featureSize = 0.1 * diagonal;
    for (const LaplacianKind kind : kKinds) {
        options.laplacian = kind;
        expectEqual(measureArtefacts(cut.mesh.V, cut.mesh.F, options).length,
                    measureArtefacts(whole.V, whole.F, options).length, 1e-12 * diagonal);
    }
    const GeometrySpectrum result = geometrySpectrum(cut.mesh.V, cut.mesh.F, {});
    const GeometrySpectrum expected = geometrySpectrum(whole.V, whole.F, {});
    EXPECT_NEAR(result.totalEnergy, expected.totalEnergy, 1e-12 * expected.totalEnergy);
    EXPECT_LE((result.octaveEnergies - expected.octaveEnergies).cwiseAbs().maxCoeff(),
              1e-6 * expected.totalEnergy);
}

INSTANTIATE_TEST_SUITE_P(Seams, CutSurface, ::testing::Values(soupOf, islandsOf));

TEST(Seams, CopiesOfAVertexMoveBitIdentically) {
    const CutMesh cut = soupOf(noisyBlob());
    FilterOptions options;
    options.featureSize = 0.3;
    options.tolerance = 1e-3;
    const Vertices filtered = fractionalFilter(cut.mesh.V, cut.mesh.F, options).V;
    std::map<Index, Index> first;
    for (Index i = 0; i < filtered.rows(); ++i) {
        const Index same = first.try_emplace(cut.origin[i], i).first->second;
        EXPECT_EQ(filtered.row(i), filtered.row(same));
    }
}

TEST(Seams, ClosedPartsThatTouchStayApart) {
    Mesh right = testing::cube(3);
    right.V.col(0).array() += 2.0;
    const Mesh both = joined(testing::cube(3), right);
    EXPECT_TRUE(findSeams(both.V, both.F, SidesByEdge(both.F)).first.empty());
    EXPECT_EQ(findSeams(both.V, both.F, SidesByEdge(both.F)).nearby, 0);
}

TEST(Seams, OpenSheetsJoinAlongACommonBoundary) {
    const Mesh left = testing::rectangle(1.0, 1.0, 4, 4);
    Mesh right = left;
    right.V.col(0).array() += 1.0;
    const Mesh both = joined(left, right);
    const Surface surface = joinedSurface(both.V, both.F);
    EXPECT_EQ(surface.copies.size(), 5u);
    EXPECT_EQ(connectedComponents(surface.F, surface.X.rows()).count, 1);
}

/// Sheets side by side; the corners of the second are off by up to `roundOff`.
Mesh nearlyJoinedSheets(double roundOff) {
    const Mesh left = testing::rectangle(1.0, 1.0, 4, 4);
    Mesh right = left;
    right.V.col(0).array() += 1.0;
    std::mt19937 generator(3);
    std::uniform_real_distribution<double> off(-roundOff, roundOff);
    right.V = right.V.unaryExpr([&](double x) { return x + off(generator); }).eval();
    return joined(left, right);
}

TEST(Seams, EdgesThatPairWithinRoundOffAreOne) {
    for (const double roundOff : {1e-12, 1e-8, 1e-6, 1e-5, 1e-3}) {
        const Mesh both = nearlyJoinedSheets(roundOff);
        const Surface surface = joinedSurface(both.V, both.F);
        EXPECT_EQ(surface.copies.size(), 5u) << roundOff;
        EXPECT_EQ(surface.nearlyCopies, 0) << roundOff;
    }
    const Mesh apart = nearlyJoinedSheets(0.1);
    EXPECT_TRUE(joinedSurface(apart.V, apart.F).copies.empty());
}

TEST(Seams, TheWidthOfACutCountsAsDisplacement) {
    for (const double roundOff : {1e-8, 1e-3}) {
        const Mesh both = nearlyJoinedSheets(roundOff);
        FilterOptions options;
        options.featureSize = 0.5;
        options.tolerance = 0.001;
        const FilterResult result = fractionalFilter(both.V, both.F, options);
        EXPECT_NEAR(result.maxDisplacement, (result.V - both.V).rowwise().norm().maxCoeff(), 1e-15)
            << roundOff;
    }
}

TEST(Seams, TrianglesWithLooseCornersAreOneSurface) {
    const Mesh whole = testing::icosphere(3);
    const double diagonal = boundingBoxDiagonal(whole.V);
    for (const double roundOff : {1e-8, 1e-6, 1e-5, 1e-4}) {
        Mesh loose = soupOf(whole).mesh;
        std::mt19937 generator(3);
        std::uniform_real_distribution<double> off(-roundOff * diagonal, roundOff * diagonal);
        loose.V = loose.V.unaryExpr([&](double x) { return x + off(generator); }).eval();
        const Surface surface = joinedSurface(loose.V, loose.F);
        EXPECT_EQ(surface.X.rows(), whole.V.rows()) << roundOff;
        EXPECT_EQ(surface.copies.size(), static_cast<std::size_t>(loose.V.rows() - whole.V.rows()));
        EXPECT_EQ(surface.F.rows(), whole.F.rows());
    }
}

TEST(Seams, WhereSeveralEdgesAreNearEachOtherTheyAreCountedButNotJoined) {
    const Mesh sheet = testing::rectangle(1.0, 1.0, 4, 4);
    Mesh right = sheet, upright = sheet;
    right.V.col(0).array() += 1.0 + 1e-8;
    upright.V.col(2) = sheet.V.col(0);
    upright.V.col(0).setConstant(1.0 - 1e-8);
    const Mesh three = joined(joined(sheet, right), upright);
    const Surface surface = joinedSurface(three.V, three.F);
    EXPECT_TRUE(surface.copies.empty());
    EXPECT_EQ(surface.nearlyCopies, 10);
    EXPECT_EQ(joinedSurface(sheet.V, sheet.F).nearlyCopies, 0);
}

TEST(Seams, ThreeSheetsJoinAtACommonEdge) {
    const Mesh sheet = testing::rectangle(1.0, 1.0, 3, 3);
    Mesh turned = sheet, opposite = sheet;
    turned.V.col(2) = sheet.V.col(0);
    turned.V.col(0).setZero();
    opposite.V.col(0) *= -1.0;
    const Mesh three = joined(joined(sheet, turned), opposite);
    const Surface surface = joinedSurface(three.V, three.F);
    EXPECT_EQ(surface.copies.size(), 8u);
    FilterOptions options;
    options.featureSize = 0.5;
    options.tolerance = 1e-3;
    EXPECT_TRUE(fractionalFilter(three.V, three.F, options).V.allFinite());
}

TEST(Seams, ValuesOnBothSidesOfASeamAreMerged) {
    const CutMesh cut = islandsOf(testing::blob());
    Eigen::VectorXd Q = cut.mesh.V.col(0);
    for (Index i = 0; i < Q.size(); ++i) Q[i] += 0.01 * static_cast<double>(i % 7);
    SignalFilterOptions options;
    options.featureSize = 0.3;
    const Eigen::VectorXd Y = filterSignal(cut.mesh.V, cut.mesh.F, Q, options).Y;
    std::map<Index, double> first;
    for (Index i = 0; i < Y.size(); ++i)
        EXPECT_EQ(Y[i], first.try_emplace(cut.origin[i], Y[i]).first->second);
}

TEST(Seams, ATriangleWithoutAreaJoinsNothing) {
    Vertices V(4, 3);
    V << 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0;
    Faces F(2, 3);
    F << 0, 1, 2, 1, 2, 3;
    const Surface surface = joinedSurface(V, F);
    EXPECT_EQ(surface.X.rows(), 4);
}

/// A square of 8 x 8 coarse cells, of which some are divided: `level(row, column)` halvings. Each
/// cell has vertices of its own.
Mesh quadtree(const std::function<int(int, int)>& level) {
    constexpr int kCells = 8;
    Mesh mesh{Vertices(0, 3), Faces(0, 3)};
    for (int row = 0; row < kCells; ++row)
        for (int column = 0; column < kCells; ++column) {
            const int n = 1 << level(row, column);
            Mesh cell = testing::rectangle(1.0, 1.0, n, n);
            cell.V.rowwise() += Eigen::RowVector3d(column, row, 0.0);
            mesh = testing::joined(mesh, cell);
        }
    return mesh;
}

/// For each vertex in the middle of a side of a cell of `size`, its distance from the middle of the
/// side's ends; all vertices by their places before.
double largestGap(const Mesh& mesh, const Vertices& moved, double size,
                  const std::function<int(int, int)>& level) {
    std::map<std::array<double, 2>, Index> at;
    for (Index i = 0; i < mesh.V.rows(); ++i) {
        const auto [found, isNew] = at.try_emplace({mesh.V(i, 0), mesh.V(i, 1)}, i);
        if (!isNew) {
            EXPECT_EQ(moved.row(i), moved.row(found->second));
        }
    }
    double largest = 0.0;
    int count = 0;
    for (int row = 0; row < 8; ++row)
        for (int column = 0; column < 8; ++column) {
            if (level(row, column) != 0) continue;
            for (int side = 0; side < 4; ++side)
                for (double share = size; share < 1.0; share += size) {
                    const double x = column + (side % 2 ? share : side / 2),
                                 y = row + (side % 2 ? side / 2 : share);
                    const auto middle = at.find({x, y});
                    if (middle == at.end()) continue;
                    const bool isAlong = side % 2;
                    const Index from = at.at({isAlong ? column : x, isAlong ? y : row}),
                                to = at.at({isAlong ? column + 1.0 : x, isAlong ? y : row + 1.0});
                    const Eigen::RowVector3d expected =
                        (1.0 - share) * moved.row(from) + share * moved.row(to);
                    largest = std::max(largest, (moved.row(middle->second) - expected).norm());
                    ++count;
                }
        }
    EXPECT_GT(count, 8);
    return largest;
}

TEST(Seams, OfLevelsOfDetailHaveNoGaps) {
    // Two, three and four levels side by side.
    for (const int most : {1, 2, 3}) {
        const auto level = [&](int row, int column) {
            return (3 * row + 5 * column) % 4 == 0 || column > 5 ? most - row % 2 * (most > 1) : 0;
        };
        Mesh mesh = quadtree(level);
        const Mesh flat = mesh;
        mesh.V.col(2) = 0.25 * mesh.V.col(0) + 0.5 * mesh.V.col(1);
        FilterOptions options;
        options.featureSize = 6.0;
        options.tolerance = 1e-3;
        const FilterResult result = fractionalFilter(mesh.V, mesh.F, options);
        EXPECT_EQ(result.components, 1);
        EXPECT_GT(result.maxDisplacement, 0.01);
        EXPECT_EQ(largestGap(flat, result.V, std::exp2(-most), level), 0.0) << most;
    }
}

}  // namespace
}  // namespace spectral
