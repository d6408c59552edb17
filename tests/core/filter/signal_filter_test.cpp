#include "core/filter/signal_filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/mesh/measures.h"
#include "core/support/errors.h"
#include "support/shapes.h"

namespace spectral {
namespace {

using testing::classesOfMeshes;
using testing::Mesh;

constexpr double kAccuracy = 1e-6;

/// A low-pass that affects every octave of these meshes.
SignalFilterOptions lowPass(const Mesh& mesh, double part = 0.2) {
    SignalFilterOptions options;
    options.featureSize = part * boundingBoxDiagonal(mesh.V);
    options.laplacian = LaplacianKind::Cotangent;
    return options;
}

Eigen::MatrixXd noise(Index rows, Index columns, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return uniform(random); });
}

double range(const Eigen::MatrixXd& Q) { return Q.maxCoeff() - Q.minCoeff(); }
double largest(const Eigen::MatrixXd& Q) { return Q.cwiseAbs().maxCoeff(); }

Eigen::MatrixXd filtered(const Mesh& mesh, const Eigen::MatrixXd& Q,
                         const SignalFilterOptions& options) {
    return filterSignal(mesh.V, mesh.F, Q, options).Y;
}

/// Root mean square error, over both signals, of the closed form on a sphere of radius r: x and x y
/// are harmonics of degree 1 and 2, whose eigenvalues are l (l + 1) / r^2.
double sphereError(int levels) {
    const double r = 3.0;
    Mesh sphere = testing::icosphere(levels);
    sphere.V *= r;
    Eigen::MatrixXd Q(sphere.V.rows(), 2), expected = Q;
    Q << sphere.V.col(0), sphere.V.col(0).cwiseProduct(sphere.V.col(1));
    SignalFilterOptions options;
    options.featureSize = 2.0 * r;  // x = omega / omega_c = sqrt(l (l + 1)) / pi
    const auto gain = [](double l) { return std::exp2(-0.5 * l * (l + 1.0) / (kPi * kPi)); };
    expected << gain(1.0) * Q.col(0), gain(2.0) * Q.col(1);
    return (filtered(sphere, Q, options) - expected).norm() / Q.norm();
}

TEST(SignalFilter, OfASphereConvergesToTheClosedFormAtSecondOrder) {
    const double coarse = sphereError(2), middle = sphereError(3), fine = sphereError(4);
    EXPECT_LT(coarse, 0.01);
    EXPECT_GT(coarse / middle, 3.5);
    EXPECT_GT(middle / fine, 3.5);
}

TEST(SignalFilter, IsLinear) {
    for (const Mesh& mesh : classesOfMeshes()) {
        const Eigen::MatrixXd P = noise(mesh.V.rows(), 1, 1), Q = noise(mesh.V.rows(), 1, 2);
        for (const Boundary boundary : {Boundary::Free, Boundary::Fixed}) {
            SignalFilterOptions options = lowPass(mesh);
            options.boundary = boundary;
            const Eigen::MatrixXd sum = filtered(mesh, 3.0 * P - 0.5 * Q, options);
            EXPECT_LT(
                largest(sum - 3.0 * filtered(mesh, P, options) + 0.5 * filtered(mesh, Q, options)),
                4.0 * kAccuracy * range(P));
        }
    }
}

TEST(SignalFilter, KeepsSignalsThatAreConstantOnEveryComponentBitIdentical) {
    for (const Mesh& mesh : classesOfMeshes())
        for (const Boundary boundary : {Boundary::Free, Boundary::Fixed}) {
            const Components components = connectedComponents(mesh.F, mesh.V.rows());
            Eigen::VectorXd Q(mesh.V.rows());
            for (Index i = 0; i < Q.size(); ++i) Q[i] = 0.1 + 0.7 * components.label[i];
            SignalFilterOptions options = lowPass(mesh);
            options.boundary = boundary;
            const FilteredSignal result = filterSignal(mesh.V, mesh.F, Q, options);
            EXPECT_TRUE(result.isConstant);
            EXPECT_TRUE((result.Y.array() == Q.array()).all());
            EXPECT_EQ(result.errorEstimate, 0.0);
            EXPECT_TRUE(result.accuracyReached);
        }
}

TEST(SignalFilter, DoesNotDependOnScaleAndOffsetOfTheValues) {
    const Mesh mesh = testing::blob();
    const Eigen::MatrixXd Q = noise(mesh.V.rows(), 1, 6), Y = filtered(mesh, Q, lowPass(mesh));
    for (const double scale : {1e-300, 1e-20, 1e20, 1e300})
        EXPECT_LT(largest(filtered(mesh, scale * Q, lowPass(mesh)) / scale - Y), 1e-12);
    const Eigen::MatrixXd offset = (Q.array() + 1e6).matrix();
    EXPECT_LT(largest((filtered(mesh, offset, lowPass(mesh)).array() - 1e6).matrix() - Y), 1e-8);
}

TEST(SignalFilter, LeavesUnreferencedAndFixedVerticesBitForBitUnchanged) {
    const Mesh mesh = testing::rectangle(2, 1, 20, 10);
    Mesh with{Vertices(mesh.V.rows() + 2, 3), (mesh.F.array() + 1).matrix()};
    with.V << Eigen::RowVector3d(9, 9, 9), mesh.V, Eigen::RowVector3d(-50, 0, 0);
    Eigen::MatrixXd Q = noise(with.V.rows(), 1, 8);
    Q(0, 0) = 0.1;
    Q(Q.rows() - 1, 0) = 1e12;  // must not affect the scale of the signal either
    const std::vector<bool> onBoundary = boundaryVertices(with.F, with.V.rows());
    for (Index i = 0; i < Q.rows(); ++i)
        if (onBoundary[i] && i % 2 == 0) Q(i, 0) = -0.0;
    SignalFilterOptions options = lowPass(mesh);
    options.boundary = Boundary::Fixed;
    const FilteredSignal result = filterSignal(with.V, with.F, Q, options);
    EXPECT_EQ(result.unreferencedVertices, 2);
    EXPECT_EQ(result.fixedVertices, 60);
    for (Index i = 0; i < Q.rows(); ++i) {
        const bool isKept = i == 0 || i == Q.rows() - 1 || onBoundary[i];
        EXPECT_EQ(result.Y(i, 0) == Q(i, 0), isKept) << i;
        EXPECT_TRUE(!isKept || std::signbit(result.Y(i, 0)) == std::signbit(Q(i, 0))) << i;
    }
    const Eigen::MatrixXd alone = filtered(mesh, Q.middleRows(1, mesh.V.rows()), options);
    EXPECT_LT(largest(result.Y.middleRows(1, mesh.V.rows()) - alone), 1e-12);
}

TEST(SignalFilter, CountsAndLocatesInfiniteValues) {
    const Mesh mesh = testing::icosphere(2);
    Eigen::MatrixXd Q = noise(mesh.V.rows(), 2, 9);
    Q(40, 1) = std::numeric_limits<double>::infinity();
    const auto message = [&] {
        try {
            filterSignal(mesh.V, mesh.F, Q, lowPass(mesh));
        } catch (const InvalidMesh& error) {
            EXPECT_EQ(error.code(), ErrorCode::ValueNotFinite);
            return std::string(error.what());
        }
        return std::string("no error");
    };
    EXPECT_EQ(message(), "1 vertex has an infinite value, the first is vertex 40");
    Q(17, 0) = -std::numeric_limits<double>::infinity();
    EXPECT_EQ(message(), "2 vertices have an infinite value, the first is vertex 17");
}

TEST(SignalFilter, RefusesBadMeshesAndOptions) {
    const Mesh mesh = testing::icosphere(2);
    const Eigen::MatrixXd Q = noise(mesh.V.rows(), 1, 9);
    SignalFilterOptions options = lowPass(mesh);
    EXPECT_THROW(filterSignal(mesh.V, Faces(0, 3), Q, options), InvalidMesh);
    options.featureSize = 0.0;
    EXPECT_THROW(filterSignal(mesh.V, mesh.F, Q, options), InvalidOption);
    options = lowPass(mesh);
    options.transferFunction.power = 2.0;
    EXPECT_THROW(filterSignal(mesh.V, mesh.F, Q, options), InvalidOption);
}

}  // namespace
}  // namespace spectral
