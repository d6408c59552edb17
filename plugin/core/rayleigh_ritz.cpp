#include "rayleigh_ritz.h"

#include <algorithm>
#include <cassert>
#include <utility>
#include <vector>

#include "dense_eigenproblems.h"
#include "errors.h"
#include "mass_products.h"
#include "panel_products.h"
#include "parallel_tasks.h"
#include "row_panels.h"

namespace spectral {

namespace {

/// Rows of S that a task makes Ritz vectors of: small beside S, large enough for products at full
/// speed.
constexpr Index kRows = 512;

/// Parts of the rows whose matrices are added in the end: enough for the cores, but few and large
/// enough for these sums to be small beside S.
constexpr Index kMostParts = 8, kLeastRows = 4096;

constexpr const char* kStage = "updating the harmonics";

/// S^T W S and S^T D S, or what some rows contribute to them: the upper halves.
struct ProjectedPair {
    Eigen::MatrixXd H, G;
};

ProjectedPair project(const Laplacian& laplacian, const Eigen::Ref<const Eigen::MatrixXd>& S,
                      const std::vector<int>& order, const Progress& progress) {
    const Index n = S.rows(), m = S.cols();
    assert(S.outerStride() == n);
    const Index parts = std::clamp(n / kLeastRows, Index{1}, kMostParts);
    std::vector<ProjectedPair> shares(static_cast<std::size_t>(parts));
    runInParallel(
        parts,
        [&](Index part, int, const StopPoint&) {
            const RowPanels rows(laplacian, order, part * n / parts, (part + 1) * n / parts);
            ProjectedPair& share = shares[static_cast<std::size_t>(part)];
            share.H = share.G = Eigen::MatrixXd::Zero(m, m);
            const std::vector<RowPanel> panels = rows.panels();
            panelProducts().add(panels.data(), static_cast<Index>(panels.size()), S.data(), n, m,
                                share.H.data(), share.G.data());
        },
        progress, kStage);
    for (std::size_t part = 1; part < shares.size(); ++part) {
        shares[0].H += shares[part].H;
        shares[0].G += shares[part].G;
    }
    return std::move(shares[0]);
}

}  // namespace

Eigen::VectorXd rayleighRitz(const Laplacian& laplacian, Eigen::Ref<Eigen::MatrixXd> S,
                             const std::vector<int>& order, const std::function<Index()>& wanted,
                             const Progress& progress) {
    const Index n = S.rows(), m = S.cols();
    ProjectedPair projected = project(laplacian, S, order, progress.part(0.0, 0.5));
    for (Eigen::MatrixXd* matrix : {&projected.H, &projected.G})
        matrix->triangularView<Eigen::StrictlyLower>() = matrix->transpose();
    Eigen::VectorXd values(m);
    Eigen::MatrixXd Z(m, m);
    bool hasConverged = false;
    Index count = m;
    runInParallel(
        2,
        [&](Index task, int, const StopPoint&) {
            if (task == 0)
                hasConverged = denseEigenproblems().generalized(
                    projected.H.data(), projected.G.data(), m, values.data(), Z.data());
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
