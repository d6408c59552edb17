#include "rayleigh_ritz.h"

#include <algorithm>
#include <vector>

#include "dense_eigenproblems.h"
#include "dense_products.h"
#include "errors.h"
#include "mass_products.h"
#include "parallel_tasks.h"
#include "symmetric_product.h"

namespace spectral {

namespace {

/// Columns and rows that a task takes: small beside S, large enough for products at full speed.
constexpr Index kColumns = 36, kRows = 512;

/// Parts of the rows whose Gram matrices are added in the end: enough for the cores, but few and
/// large enough for these sums to be small beside S.
constexpr Index kMostParts = 8, kLeastRows = 4096;

constexpr const char* kStage = "updating the harmonics";

}  // namespace

Eigen::VectorXd rayleighRitz(const Laplacian& laplacian, Eigen::Ref<Eigen::MatrixXd> S,
                             const std::function<Index()>& wanted, const Progress& progress) {
    const Index n = S.rows(), m = S.cols();
    Eigen::MatrixXd H(m, m);  // S^T W S, its upper half
    const Index blocks = (m + kColumns - 1) / kColumns;
    const Index parts = std::clamp(n / kLeastRows, Index{1}, kMostParts);
    std::vector<Eigen::MatrixXd> grams(static_cast<std::size_t>(parts));  // add up to S^T D S
    runInParallel(
        blocks + parts,
        [&](Index task, int, const StopPoint&) {
            if (task < blocks) {
                // The last block has the most rows of the upper half: it goes first.
                const Index first = (blocks - 1 - task) * kColumns;
                const Index count = std::min(kColumns, m - first);
                const Eigen::MatrixXd WS =
                    symmetricProduct(laplacian.W, S.middleCols(first, count));
                denseProducts().transposedProduct(S.data(), S.outerStride(), WS.data(), n,
                                                  &H(0, first), m, n, first + count, count);
                return;
            }
            const Index part = task - blocks, begin = part * n / parts;
            const Index rows = (part + 1) * n / parts - begin;
            grams[static_cast<std::size_t>(part)] =
                gramMatrix(S.middleRows(begin, rows), laplacian.D.segment(begin, rows));
        },
        progress.part(0.0, 0.5), kStage);
    Eigen::MatrixXd& G = grams[0];
    for (std::size_t part = 1; part < grams.size(); ++part) G += grams[part];
    H.triangularView<Eigen::StrictlyLower>() = H.transpose();
    Eigen::VectorXd values(m);
    Eigen::MatrixXd Z(m, m);
    bool hasConverged = false;
    Index count = m;
    runInParallel(
        2,
        [&](Index task, int, const StopPoint&) {
            if (task == 0)
                hasConverged = denseEigenproblems().generalized(H.data(), G.data(), m,
                                                                values.data(), Z.data());
            else
                count = wanted();
        },
        progress.part(0.5, 0.6), kStage);
    if (!hasConverged) throw SolverFailure("the Ritz vectors of dependent vectors do not exist");
    Z.conservativeResize(m, count);
    runInParallel((n + kRows - 1) / kRows,
                  [&](Index task, int, const StopPoint&) {
                      const Index first = task * kRows;
                      multiplyInPlace(S.middleRows(first, std::min(kRows, n - first)), Z);
                  },
                  progress.part(0.6, 1.0), kStage);
    return values.head(count);
}

}  // namespace spectral
