#include "core/mesh/displacement_limit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/laplacian/laplacian.h"
#include "core/support/types.h"
#include "support/shapes.h"

namespace spectral {
namespace {

/// A bump of height 1 and of a width of 20 edges, up along z.
Vertices bump(const Vertices& X) {
    Vertices up = Vertices::Zero(X.rows(), 3);
    for (Index i = 0; i < X.rows(); ++i)
        up(i, 2) = std::exp(-(X.row(i).head<2>() - Eigen::RowVector2d(20.0, 20.0)).squaredNorm() /
                            (2.0 * 100.0));
    return up;
}

TEST(DisplacementLimit, KeepsTheBoundAtEveryVertexAndTellsItsArea) {
    const testing::Mesh mesh = testing::rectangle(40.0, 40.0, 40, 40);
    const Eigen::VectorXd areas = lumpedMass(mesh.V, mesh.F);
    for (const double bound : {0.2, 0.3, 0.9}) {
        Vertices moved = bump(mesh.V);
        const double share = limitDisplacement(mesh.F, areas, bound, 8, moved);
        EXPECT_LE(moved.rowwise().norm().maxCoeff(), bound * (1.0 + 1e-12));
        // A disc where the bump is higher.
        const double radius = 10.0 * std::sqrt(-2.0 * std::log(bound));
        const double whole = std::min(1.0, kPi * radius * radius / 1600.0);
        EXPECT_NEAR(share, whole, 0.01);
    }
}

TEST(DisplacementLimit, LeavesNoRidgeWhereItBegins) {
    const testing::Mesh mesh = testing::rectangle(40.0, 40.0, 40, 40);
    const Eigen::VectorXd areas = lumpedMass(mesh.V, mesh.F);
    const Vertices whole = bump(mesh.V);
    Vertices smooth = whole;
    limitDisplacement(mesh.F, areas, 0.4, 8, smooth);
    const Vertices clipped = whole.cwiseMin(0.4);
    // Second differences along the middle row; a clip has them in one edge.
    const auto sharpest = [](const Vertices& moved) {
        double most = 0.0;
        for (Index j = 1; j < 40; ++j) {
            const Index i = 20 * 41 + j;
            most = std::max(most, std::abs(moved(i - 1, 2) - 2.0 * moved(i, 2) + moved(i + 1, 2)));
        }
        return most;
    };
    EXPECT_LT(sharpest(smooth), 0.5 * sharpest(clipped));
}

TEST(DisplacementLimit, LeavesWhatIsWithinItBitForBit) {
    const testing::Mesh mesh = testing::rectangle(40.0, 40.0, 40, 40);
    const Eigen::VectorXd areas = lumpedMass(mesh.V, mesh.F);
    for (const double bound : {0.0, 1.001}) {
        Vertices moved = bump(mesh.V);
        EXPECT_EQ(limitDisplacement(mesh.F, areas, bound, 8, moved), 0.0);
        EXPECT_EQ(moved, bump(mesh.V));
    }
    // Far from where it is longer, too.
    Vertices moved = bump(mesh.V);
    limitDisplacement(mesh.F, areas, 0.9, 4, moved);
    EXPECT_EQ(moved.row(0), bump(mesh.V).row(0));
}

}  // namespace
}  // namespace spectral
