#include "rayleigh_ritz.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "dense_products.h"
#include "errors.h"
#include "mass_products.h"
#include "parallel_tasks.h"
#include "symmetric_product.h"

namespace spectral {

namespace {

/// Columns and rows that a task takes: small beside S, large enough for products at full speed.
constexpr Index kColumns = 48, kRows = 1024;

}  // namespace

Eigen::VectorXd rayleighRitz(const Laplacian& laplacian, Eigen::Ref<Eigen::MatrixXd> S,
                             const Progress& progress) {
    const Index n = S.rows(), m = S.cols();
    const DenseProducts& products = denseProducts();
    Eigen::MatrixXd H(m, m), G(m, m);  // S^T W S and S^T D S, their upper halves
    const Index blocks = (m + kColumns - 1) / kColumns;
    runInParallel(
        blocks,
        [&](Index task, int, const StopPoint&) {
            // The last block has the most rows of the upper half: it goes first.
            const Index first = (blocks - 1 - task) * kColumns;
            const Index count = std::min(kColumns, m - first), rows = first + count;
            const auto upperHalf = [&](const Eigen::MatrixXd& AS, Eigen::MatrixXd& gram) {
                products.transposedProduct(S.data(), S.outerStride(), AS.data(), n, &gram(0, first),
                                           m, n, rows, count);
            };
            upperHalf(symmetricProduct(laplacian.W, S.middleCols(first, count)), H);
            upperHalf(laplacian.D.asDiagonal() * S.middleCols(first, count), G);
        },
        progress.part(0.0, 0.5), "updating the harmonics");
    G.triangularView<Eigen::StrictlyLower>() = G.transpose();
    H.triangularView<Eigen::StrictlyLower>() = H.transpose();
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> ritz(H, G);
    if (ritz.info() != Eigen::Success || !ritz.eigenvectors().allFinite())
        throw SolverFailure("the Ritz vectors of dependent vectors do not exist");
    const Eigen::MatrixXd& Z = ritz.eigenvectors();
    runInParallel((n + kRows - 1) / kRows,
                  [&](Index task, int, const StopPoint&) {
                      const Index first = task * kRows;
                      multiplyInPlace(S.middleRows(first, std::min(kRows, n - first)), Z);
                  },
                  progress.part(0.5, 1.0), "updating the harmonics");
    return ritz.eigenvalues();
}

}  // namespace spectral
