#include "core/analysis/manifold_harmonics.h"

#include <gtest/gtest.h>

#include "core/laplacian/laplacian.h"
#include "core/mesh/mesh.h"
#include "support/shapes.h"

namespace spectral {
namespace {

using testing::Mesh;

HarmonicsOptions ofSize(int k, LaplacianKind kind = LaplacianKind::IntrinsicDelaunay) {
    HarmonicsOptions options;
    options.basisSize = k;
    options.laplacian = kind;
    return options;
}

ManifoldHarmonics harmonicsOf(const Mesh& mesh, int k,
                              LaplacianKind kind = LaplacianKind::IntrinsicDelaunay) {
    return manifoldHarmonics(mesh.V, mesh.F, ofSize(k, kind));
}

TEST(ManifoldHarmonics, ReportTheSizeThatSplitsNoMultipleEigenvalue) {
    const Mesh sphere = testing::icosphere(3);
    const ManifoldHarmonics cut = harmonicsOf(sphere, 11);  // of 1 + 3 + 5 + 7
    EXPECT_EQ(cut.lambda.size(), 11);
    EXPECT_EQ(cut.wholeSize, 16);
    EXPECT_EQ(harmonicsOf(sphere, 9).wholeSize, 9);
}

TEST(FixSigns, MakesTheExtremeEntryPositive) {
    Eigen::MatrixXd Phi(3, 2);
    Phi << 1.0, 0.5, -3.0, 2.0, 2.0, -1.0;
    fixSigns(Phi);
    EXPECT_EQ(Phi(1, 0), 3.0);
    EXPECT_EQ(Phi(0, 0), -1.0);
    EXPECT_EQ(Phi(1, 1), 2.0);
}

TEST(FixSigns, UsesTheFirstOfEntriesThatDifferOnlyByRoundOff) {
    for (const double noise : {1e-9, -1e-9}) {
        Eigen::MatrixXd Phi(4, 1);
        Phi << 0.1, -1.0, 1.0 + noise, 0.3;
        fixSigns(Phi);
        EXPECT_EQ(Phi(1, 0), 1.0) << noise;
    }
}

}  // namespace
}  // namespace spectral
