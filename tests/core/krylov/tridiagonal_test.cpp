#include "core/krylov/tridiagonal.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <vector>

#include "core/support/errors.h"
#include "core/support/types.h"

namespace spectral {
namespace {

/// The second difference on m points: eigenvalues 2 - 2 cos(pi j / (m + 1)), j = 1 to m.
TEST(Tridiagonal, AgreesWithTheClosedFormAtAnyScale) {
    constexpr int m = 60;
    for (const double scale : {1.0, 1e-14, 1e14}) {
        const auto T = eigenpairsOfTridiagonal(std::vector<double>(m, 2.0 * scale),
                                               std::vector<double>(m - 1, -scale));
        for (int j = 0; j < m; ++j)
            EXPECT_NEAR(T.values[j] / scale, 2.0 - 2.0 * std::cos(kPi * (j + 1) / (m + 1)), 1e-13);
        const Eigen::MatrixXd gram = T.vectors.transpose() * T.vectors;
        EXPECT_LT((gram - Eigen::MatrixXd::Identity(m, m)).cwiseAbs().maxCoeff(), 1e-13);
    }
}

TEST(Tridiagonal, OfOneEntryIsItself) {
    EXPECT_EQ(eigenpairsOfTridiagonal({-3.0}, {}).values[0], -3.0);
}

TEST(Tridiagonal, RefusesWhatIsNotFinite) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(eigenpairsOfTridiagonal({1.0, nan, 2.0}, {0.5, 0.5}), SolverFailure);
}

}  // namespace
}  // namespace spectral
