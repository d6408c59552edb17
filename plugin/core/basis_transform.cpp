#include "basis_transform.h"

#include <algorithm>
#include <vector>

#include "dense_products.h"
#include "mass_products.h"
#include "parallel_tasks.h"
#include "types.h"

namespace spectral {

namespace {

/// Rows that a task takes, and how many of them at a time: these stay in the cache.
constexpr Index kRows = 4096, kRowsAtOnce = 512;

constexpr const char* kStage = "filtering";

Index blocksOf(Index rows) { return (rows + kRows - 1) / kRows; }

}  // namespace

Eigen::MatrixXd harmonicTransform(const Eigen::Ref<const Eigen::MatrixXd>& Phi,
                                  const Eigen::VectorXd& D, const Eigen::MatrixXd& X,
                                  const Progress& progress) {
    const Index n = X.rows();
    std::vector<Eigen::MatrixXd> parts(static_cast<std::size_t>(blocksOf(n)));
    runInParallel(
        blocksOf(n),
        [&](Index block, int, const StopPoint&) {
            const Index first = block * kRows, count = std::min(kRows, n - first);
            parts[static_cast<std::size_t>(block)] = innerProducts(
                Phi.middleRows(first, count), D.segment(first, count), X.middleRows(first, count));
        },
        progress, kStage);
    Eigen::MatrixXd C = Eigen::MatrixXd::Zero(Phi.cols(), X.cols());
    for (const Eigen::MatrixXd& part : parts) C += part;
    return C;
}

Eigen::MatrixXd inverseHarmonicTransform(const Eigen::Ref<const Eigen::MatrixXd>& Phi,
                                         const Eigen::MatrixXd& C, const Progress& progress) {
    const Index n = Phi.rows(), k = Phi.cols();
    Eigen::MatrixXd X(n, C.cols());
    runInParallel(
        blocksOf(n),
        [&](Index block, int, const StopPoint&) {
            const Index end = std::min(n, (block + 1) * kRows);
            for (Index row = block * kRows; row < end; row += kRowsAtOnce)
                denseProducts().product(&Phi.coeffRef(row, 0), Phi.outerStride(), C.data(), k,
                                        &X(row, 0), n, std::min(kRowsAtOnce, end - row), k,
                                        C.cols());
        },
        progress, kStage);
    return X;
}

}  // namespace spectral
