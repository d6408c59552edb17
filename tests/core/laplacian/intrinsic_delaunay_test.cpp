#include "core/laplacian/intrinsic_delaunay.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "core/laplacian/laplacian_builder.h"
#include "core/ldlt/shifted_ldlt.h"
#include "core/mesh/mesh.h"
#include "support/dense_eigenpairs.h"
#include "support/evaluation.h"

namespace spectral {
namespace {

using testing::Mesh;

SparseMatrix intrinsicStiffness(const Mesh& mesh) {
    return IntrinsicDelaunay(mesh.V, mesh.F).stiffness(mesh.V);
}

/// Every kind of mesh that plain cotangents cannot deal with.
std::vector<Mesh> brokenMeshes() {
    std::vector<Mesh> meshes;
    const Mesh blob = testing::blob();

    Mesh duplicates = blob;  // faces 0 to 9 once more, half of them turned over
    duplicates.F.conservativeResize(blob.F.rows() + 10, 3);
    duplicates.F.bottomRows(10) = blob.F.topRows(10);
    duplicates.F.bottomRows(5).col(1).swap(duplicates.F.bottomRows(5).col(2));
    meshes.push_back(duplicates);

    Mesh fins = blob;  // triangles that stand on edges, so that these have three
    fins.V.conservativeResize(blob.V.rows() + 1, 3);
    fins.V.bottomRows(1) << 2.0, 2.0, 2.0;
    fins.F.conservativeResize(blob.F.rows() + 3, 3);
    for (int k = 0; k < 3; ++k)
        fins.F.row(blob.F.rows() + k) << blob.F(40 * k, 0), blob.F(40 * k, 1),
            static_cast<int>(blob.V.rows());
    meshes.push_back(fins);

    Mesh collapsed = blob;  // a fan shrunk to a point, other corners moved onto an edge
    for (int k = 0; k < 3; ++k) collapsed.V.row(blob.F(7, k)) = blob.V.row(blob.F(7, 0));
    collapsed.V.row(blob.F(300, 2)) =
        0.5 * (blob.V.row(blob.F(300, 0)) + blob.V.row(blob.F(300, 1)));
    meshes.push_back(collapsed);

    Mesh flat = blob;  // crushed almost to a line
    flat.V.col(0) *= 1e-9;
    flat.V.col(1) *= 1e-9;
    meshes.push_back(flat);

    Mesh turned = blob;  // neighbours of opposite orientation
    for (int t = 0; t < 100; ++t) std::swap(turned.F(t, 1), turned.F(t, 2));
    meshes.push_back(turned);

    Mesh pinched = testing::joined(testing::icosphere(1), testing::icosphere(1));
    pinched.V.bottomRows(42).col(0).array() += 2.0;
    pinched.F = pinched.F.unaryExpr([](int i) { return i == 42 ? 3 : i; }).eval();
    pinched.V.row(42) = pinched.V.row(41);  // left out of all triangles
    const Surface surface = surfaceOf(pinched.V, pinched.F);
    meshes.push_back({surface.X, surface.F});  // two spheres with one common vertex

    meshes.push_back(testing::withNoise(testing::rectangle(2, 1, 20, 10), 0.08, 6));
    return meshes;
}

TEST(IntrinsicDelaunay, GivesNonNegativeWeightsAndAUsableLaplacianOnAnyMesh) {
    int number = 0;
    for (const Mesh& mesh : brokenMeshes()) {
        const Surface surface{mesh.V, mesh.F, {}};
        const Laplacian laplacian =
            LaplacianBuilder(surface, connectedComponents(surface.F, surface.X.rows()),
                             LaplacianKind::IntrinsicDelaunay, BasisUpdate::Full)
                .current();
        ASSERT_TRUE(isUsable(laplacian)) << number;
        double largestOffDiagonal = 0.0;
        for (int k = 0; k < laplacian.W.outerSize(); ++k)
            for (SparseMatrix::InnerIterator it(laplacian.W, k); it; ++it)
                if (it.row() != it.col())
                    largestOffDiagonal = std::max(largestOffDiagonal, it.value());
        EXPECT_LE(largestOffDiagonal, 0.0) << number;
        ShiftedLdlt ldlt;
        EXPECT_NO_THROW(ldlt.factorizeDefinite(laplacian.W, laplacian.D, 1.0)) << number;
        ++number;
    }
}

TEST(IntrinsicDelaunay, IsPositiveSemidefiniteWithRowsThatSumToZero) {
    for (const Mesh& mesh : brokenMeshes()) {
        const Eigen::MatrixXd W = intrinsicStiffness(mesh);
        const double scale = W.cwiseAbs().maxCoeff();
        EXPECT_EQ(W, W.transpose());
        EXPECT_LT(W.rowwise().sum().cwiseAbs().maxCoeff(), 1e-11 * scale);
        EXPECT_GT(testing::denseEigenvalues(W)[0], -1e-11 * scale);
    }
}

/// By how much the cotangent opposite a side changes at most when the three lengths of its triangle
/// change by one part in 2^52: the angle by twice that times the other two cotangents. Next to
/// nothing, but 4 in a needle of 1 : 1.5e8, whose cotangents are of that size.
double roundOff(const IntrinsicTriangulation& triangulation, int side) {
    const double cotangent = triangulation.cotangent(side);
    return 2.0 * std::numeric_limits<double>::epsilon() * (1.0 + cotangent * cotangent) *
           (std::abs(triangulation.cotangent(nextSide(side))) +
            std::abs(triangulation.cotangent(previousSide(side))));
}

/// Least sum of the cotangents opposite any edge, of lengths that may each be off by one rounding.
double leastEdgeCotangents(const Mesh& mesh) {
    const IntrinsicTriangulation delaunay = IntrinsicDelaunay(mesh.V, mesh.F).triangulation(mesh.V);
    double least = std::numeric_limits<double>::infinity();
    for (int s = 0; s < delaunay.sideCount(); ++s)
        least = std::min(least, delaunay.edgeCotangents(s) + roundOff(delaunay, s) +
                                    roundOff(delaunay, delaunay.twin(s)));
    return least;
}

/// Numbers from -1 to 1, the same with every standard library and every version of Eigen.
class Uniform {
  public:
    explicit Uniform(unsigned seed) : generator_(seed) {}
    double operator()() { return 2.0 * (static_cast<double>(generator_()) / 4294967296.0) - 1.0; }
    /// A whole number from 1 to `largest`.
    int upTo(int largest) { return 1 + static_cast<int>(generator_() % largest); }

  private:
    std::mt19937 generator_;
};

Mesh turnedAtRandom(Mesh mesh, Uniform& uniform) {
    Eigen::Vector4d q;
    for (double& coordinate : q) coordinate = uniform();
    mesh.V = (mesh.V * Eigen::Quaterniond(q.normalized()).toRotationMatrix()).eval();
    return mesh;
}

Mesh shiftedAtRandom(Mesh mesh, Uniform& uniform) {
    Eigen::RowVector3d shift;
    for (double& coordinate : shift) coordinate = uniform();
    mesh.V.rowwise() += shift;
    return mesh;
}

Mesh roundedToFloat(Mesh mesh) {
    mesh.V = mesh.V.cast<float>().cast<double>().eval();
    return mesh;
}

/// Meshes with many edges that are diagonals of rectangles: both opposite angles are right angles.
std::vector<Mesh> rectangularMeshes() {
    std::vector<Mesh> meshes{testing::rectangle(1, 1, 1, 1),
                             testing::rectangle(3, 1, 40, 7),
                             testing::rectangle(1e-3, 1e4, 30, 2),
                             testing::cube(9),
                             testing::joined(testing::cube(4), testing::rectangle(5, 1, 50, 50)),
                             testing::segmentedBall(9)};
    const std::size_t count = meshes.size();
    for (std::size_t i = 0; i < count; ++i) {
        Uniform uniform(static_cast<unsigned>(i));
        for (int turn = 0; turn < 20; ++turn) {
            Mesh turned = shiftedAtRandom(turnedAtRandom(meshes[i], uniform), uniform);
            turned.V *= std::pow(10.0, 3 * turn / 2 - 15);
            meshes.push_back(turn % 3 == 0 ? roundedToFloat(turned) : turned);
        }
    }
    return meshes;
}

TEST(IntrinsicDelaunay, LeavesNoEdgeWithANegativeWeight) {
    for (const Mesh& mesh : rectangularMeshes()) EXPECT_GT(leastEdgeCotangents(mesh), -1e-9);
    for (const Mesh& mesh : brokenMeshes()) EXPECT_GT(leastEdgeCotangents(mesh), -1e-6);
}

TEST(IntrinsicDelaunay, OfAnyNeedlesIsFiniteAndDelaunay) {
    for (const double width : {10.0, 1.0, 0.1, 1e-2, 1e-3, 1e-4, 1e-5})
        for (unsigned seed = 0; seed < 300; ++seed) {
            Uniform uniform(seed);
            const double height = std::pow(10.0, 2.5 + 1.5 * uniform());
            const int nx = uniform.upTo(40), ny = uniform.upTo(12);
            const Mesh flat = testing::rectangle(width, height, nx, ny);
            Mesh needles = shiftedAtRandom(turnedAtRandom(flat, uniform), uniform);
            if (seed % 3 > 0) needles = roundedToFloat(needles);
            EXPECT_TRUE(intrinsicStiffness(needles).coeffs().allFinite()) << width << ' ' << seed;
            EXPECT_GT(leastEdgeCotangents(needles), -1e-9) << width << ' ' << seed;
        }
}

/// A rectangle of needles.
struct NeedleRectangle {
    double width, height;
    int nx, ny;
};

/// 31 x 3 or 11 x 11 vertices; the last one's cells are 150 million times as long as they are wide.
constexpr NeedleRectangle kNeedleRectangles[] = {{0.1, 100, 30, 2},   {0.01, 100, 30, 2},
                                                 {1e-3, 100, 30, 2},  {1, 1000, 10, 10},
                                                 {0.1, 1000, 10, 10}, {1e-3, 1e4, 30, 2}};

/// Eigenvalues of a flat rectangle: the weights of its grid and the areas of its triangles, without
/// any cotangent.
Eigen::VectorXd gridEigenvalues(const NeedleRectangle& of, const Mesh& mesh) {
    const double dx = of.width / of.nx, dy = of.height / of.ny;
    const Index n = mesh.V.rows();
    Eigen::MatrixXd W = Eigen::MatrixXd::Zero(n, n);
    for (Index i = 0; i < n; ++i)
        for (Index j = 0; j < i; ++j) {
            const auto x = static_cast<int>(std::round(mesh.V(i, 0) / dx)),
                       y = static_cast<int>(std::round(mesh.V(i, 1) / dy));
            const auto p = static_cast<int>(std::round(mesh.V(j, 0) / dx)),
                       q = static_cast<int>(std::round(mesh.V(j, 1) / dy));
            double weight = 0.0;
            if (y == q && std::abs(x - p) == 1) weight = (y % of.ny == 0 ? 0.5 : 1.0) * dy / dx;
            if (x == p && std::abs(y - q) == 1) weight = (x % of.nx == 0 ? 0.5 : 1.0) * dx / dy;
            W(i, j) = W(j, i) = -weight;
            W(i, i) += weight;
            W(j, j) += weight;
        }
    return testing::denseEigenpairs(W, lumpedMass(mesh.V, mesh.F)).values;
}

double largestOffDiagonal(const SparseMatrix& W) {
    double largest = 0.0;
    for (int j = 0; j < W.outerSize(); ++j)
        for (SparseMatrix::InnerIterator it(W, j); it; ++it)
            if (it.row() != it.col()) largest = std::max(largest, it.value());
    return largest;
}

TEST(IntrinsicDelaunay, EndsOnEveryRotationOfARectangleOfNeedles) {
    Uniform uniform(1);
    for (const NeedleRectangle& of : kNeedleRectangles) {
        const Mesh flat = testing::rectangle(of.width, of.height, of.nx, of.ny);
        for (int turn = 0; turn < 200; ++turn) {
            const Mesh mesh = turnedAtRandom(flat, uniform);
            EXPECT_LE(largestOffDiagonal(intrinsicStiffness(mesh)), 0.0);
            EXPECT_LE(largestOffDiagonal(intrinsicStiffness(roundedToFloat(mesh))), 0.0);
        }
    }
}

TEST(IntrinsicDelaunay, OfNeedlesHasTheEigenvaluesOfTheFlatRectangle) {
    Uniform uniform(2);
    for (const NeedleRectangle& of : kNeedleRectangles) {
        if (of.height > 1e6 * of.width) continue;  // no row of W can hold both kinds of weights
        const Mesh flat = testing::rectangle(of.width, of.height, of.nx, of.ny);
        const Eigen::VectorXd expected = gridEigenvalues(of, flat);
        // The error of a dense solver, and of W, relative to the largest eigenvalue; the weights
        // along and across share a diagonal entry of W.
        const Eigen::VectorXd tolerance = 10.0 * expected.tail(1)[0] *
                                          std::numeric_limits<double>::epsilon() *
                                          expected.cwiseMax(expected[1]).cwiseInverse();
        for (int turn = 0; turn < 20; ++turn) {
            const Mesh mesh = turnedAtRandom(flat, uniform);
            const auto eigenvalues = [](const Mesh& m) {
                return testing::denseEigenpairs(intrinsicStiffness(m), lumpedMass(m.V, m.F)).values;
            };
            const Eigen::VectorXd exact = eigenvalues(mesh);
            for (Index k = 1; k < expected.size(); ++k)
                EXPECT_NEAR(exact[k] / expected[k], 1.0, 1e-9 + tolerance[k]) << k;
            // Rounding moves the vertices across by up to a quarter of a cell, along by nothing.
            const Eigen::VectorXd rounded = eigenvalues(roundedToFloat(mesh));
            for (Index k = 1; k <= of.ny; ++k)
                EXPECT_NEAR(rounded[k] / expected[k], 1.0, 1e-3 + tolerance[k]) << k;
        }
    }
}

TEST(IntrinsicDelaunay, OfARectangleIsThatOfItsGrid) {
    // Diagonals have weight 0, whichever way they run: W is that of a grid of squares, with half
    // the weight along the boundary.
    Mesh mesh = testing::rectangle(8, 5, 8, 5);
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
    mesh.V = (mesh.V * turn.toRotationMatrix()).eval();
    const SparseMatrix W = intrinsicStiffness(mesh);
    for (int j = 0; j < W.outerSize(); ++j)
        for (SparseMatrix::InnerIterator w(W, j); w; ++w) {
            const double distance = (mesh.V.row(w.row()) - mesh.V.row(j)).norm();
            if (distance < 0.5) continue;
            const double weight = -w.value();
            const double expected = distance > 1.2 ? 0.0 : weight > 0.75 ? 1.0 : 0.5;
            EXPECT_NEAR(weight, expected, 1e-4);
        }
}

TEST(IntrinsicDelaunay, EqualsTheCotangentMatrixWhereTheMeshIsDelaunay) {
    // All triangles of an icosphere are acute; its triangulation is already the Delaunay one.
    const Mesh mesh = testing::icosphere(3);
    const Eigen::MatrixXd cotangent = testing::cotangentLaplacian(mesh.V, mesh.F).W;
    EXPECT_LT((Eigen::MatrixXd(intrinsicStiffness(mesh)) - cotangent).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(IntrinsicDelaunay, FlipsTheLongDiagonalOfAKite) {
    // Two obtuse triangles on the edge (0, 1), flipped to the edge (2, 3): computed by hand, on the
    // double cover of a sheet with boundary.
    Mesh kite{Vertices(4, 3), Faces(2, 3)};
    kite.V << -2, 0, 0, 2, 0, 0, 0, 1, 0, 0, -1, 0;
    kite.F << 0, 1, 2, 1, 0, 3;
    const Eigen::MatrixXd W = intrinsicStiffness(kite);
    EXPECT_NEAR(W(0, 1), 0.0, 1e-12);
    // Opposite angles of (2, 3) at 0 and 1: tan of half of it is 1/2, so cot is 3/4.
    EXPECT_NEAR(W(2, 3), -0.75, 1e-12);
    // Opposite angle of (0, 2) at 3: tan is 2.
    EXPECT_NEAR(W(0, 2), -0.25, 1e-12);
}

TEST(IntrinsicDelaunay, LengthensTheSidesOfANeedleOnALineByATenthOfItsShortest) {
    // Less than 1e-5 mean edges, as of other triangles. The front and the back of the triangle are
    // glued along all three sides.
    constexpr double kShort = 1e-5, kLonger = 0.1 * kShort;
    Mesh needle{Vertices(3, 3), Faces(1, 3)};
    needle.V << 0, 0, 0, 1, 0, 0, 1 + kShort, 0, 0;
    needle.F << 0, 1, 2;
    const double ab = 1 + kLonger, bc = kShort + kLonger, ca = 1 + kShort + kLonger;
    IntrinsicTriangulation expected({0, 1, 2, 0, 2, 1}, {5, 4, 3, 2, 1, 0},
                                    {ab, bc, ca, ca, bc, ab});
    expected.makeDelaunay();
    const IntrinsicTriangulation found =
        IntrinsicDelaunay(needle.V, needle.F).triangulation(needle.V);
    ASSERT_EQ(found.sideCount(), expected.sideCount());
    for (int side = 0; side < expected.sideCount(); ++side) {
        EXPECT_EQ(found.tail(side), expected.tail(side));
        EXPECT_NEAR(found.cotangent(side) / expected.cotangent(side), 1.0, 1e-6);
    }
}

TEST(IntrinsicDelaunay, TakesOneCopyOfAClosedOrientedSurfaceAndTwoOfAnyOther) {
    const Mesh blob = testing::blob(), sheet = testing::rectangle(1, 1, 3, 3);
    const auto sidesOfCover = [](const Mesh& mesh) {
        return IntrinsicDelaunay(mesh.V, mesh.F).triangulation(mesh.V).sideCount();
    };
    EXPECT_EQ(sidesOfCover(blob), 3 * blob.F.rows());
    EXPECT_EQ(sidesOfCover(sheet), 2 * 3 * sheet.F.rows());
}

TEST(IntrinsicDelaunay, DoesNotDependOnTheOrientationOfFaces) {
    const Mesh mesh = testing::withNoise(testing::blob(), 0.05, 2);
    Mesh turned = mesh;
    for (Index t = 0; t < mesh.F.rows(); t += 3) std::swap(turned.F(t, 1), turned.F(t, 2));
    const Eigen::MatrixXd one = intrinsicStiffness(mesh), two = intrinsicStiffness(turned);
    EXPECT_LT((one - two).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(IntrinsicDelaunay, OfAPlaneDoesNotDependOnItsTriangulation) {
    // Points in general position have one Delaunay triangulation, whatever the given one; away from
    // the mollified boundary the weights are the same.
    Mesh mesh = testing::rectangle(2, 1, 12, 6);
    const Vertices shaken = testing::withNoise(mesh, 0.03, 8).V;
    for (Index i = 0; i < mesh.V.rows(); ++i) {
        const bool inside =
            mesh.V(i, 0) > 0 && mesh.V(i, 0) < 2 && mesh.V(i, 1) > 0 && mesh.V(i, 1) < 1;
        if (inside) mesh.V.row(i).head(2) = shaken.row(i).head(2);
    }
    Mesh other = mesh;  // every cell cut along its other diagonal
    for (Index t = 0; t < mesh.F.rows(); t += 2) {
        const int a = mesh.F(t, 0), b = mesh.F(t, 1), c = mesh.F(t, 2), d = mesh.F(t + 1, 2);
        other.F.row(t) << a, b, d;
        other.F.row(t + 1) << b, c, d;
    }
    const Eigen::MatrixXd one = intrinsicStiffness(mesh), two = intrinsicStiffness(other);
    EXPECT_LT((one - two).cwiseAbs().maxCoeff(), 1e-9);
}

}  // namespace
}  // namespace spectral
