#include "core/analysis/coarse_surface.h"

#include <limits>
#include <utility>

namespace spectral {

namespace {

/// The cells: each begins at the first vertex that has none, and takes the connected vertices
/// within `spacing` that are nearer to its centre than to that of an earlier one.
/// @return  the cell of each vertex, and the centres.
std::pair<std::vector<int>, std::vector<Index>> cellsOf(const Vertices& X, const SparseMatrix& W,
                                                        double spacing) {
    std::vector<int> cell(static_cast<std::size_t>(X.rows()), -1);
    std::vector<double> nearest(cell.size(), std::numeric_limits<double>::infinity());
    std::vector<Index> centres, next;
    for (Index centre = 0; centre < X.rows(); ++centre) {
        if (cell[centre] >= 0) continue;
        const int label = static_cast<int>(centres.size());
        centres.push_back(centre);
        nearest[centre] = 0.0;
        cell[centre] = label;
        next.push_back(centre);
        while (!next.empty()) {
            const Index i = next.back();
            next.pop_back();
            for (SparseMatrix::InnerIterator entry(W, i); entry; ++entry) {
                const Index j = entry.index();
                const double distance = (X.row(j) - X.row(centre)).norm();
                if (distance > spacing || distance >= nearest[j]) continue;
                nearest[j] = distance;
                cell[j] = label;
                next.push_back(j);
            }
        }
    }
    return {std::move(cell), std::move(centres)};
}

}  // namespace

Eigen::VectorXd CoarseSurface::meansOf(const Eigen::VectorXd& signal,
                                       const Eigen::VectorXd& D) const {
    Eigen::VectorXd sums = Eigen::VectorXd::Zero(laplacian.D.size());
    for (Index i = 0; i < signal.size(); ++i) sums[cell[i]] += D[i] * signal[i];
    return sums.cwiseQuotient(laplacian.D);
}

Eigen::VectorXd CoarseSurface::constantIn(const Eigen::VectorXd& values) const {
    Eigen::VectorXd signal(static_cast<Index>(cell.size()));
    for (Index i = 0; i < signal.size(); ++i) signal[i] = values[cell[i]];
    return signal;
}

CoarseSurface coarsened(const MeshLaplacian& mesh, const Vertices& smooth, double spacing) {
    const auto& [W, D, constants] = mesh.laplacian;
    auto [cell, centres] = cellsOf(mesh.surface.X, W, spacing);
    const auto count = static_cast<Index>(centres.size());
    CoarseSurface coarse{std::move(cell),
                         {SparseMatrix(count, count), Eigen::VectorXd::Zero(count)}};
    std::vector<Eigen::Triplet<double>> entries;
    for (Index j = 0; j < W.outerSize(); ++j) {
        coarse.laplacian.D[coarse.cell[j]] += D[j];
        for (SparseMatrix::InnerIterator entry(W, j); entry; ++entry)
            entries.emplace_back(coarse.cell[entry.index()], coarse.cell[j], entry.value());
    }
    SparseMatrix& stiffness = coarse.laplacian.W;
    stiffness.setFromTriplets(entries.begin(), entries.end());
    double energy = 0.0, inCells = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        const Eigen::VectorXd x = smooth.col(axis), means = coarse.meansOf(x, D);
        energy += x.dot(W * x);
        inCells += means.dot(stiffness * means);
    }
    if (inCells > 0.0) stiffness *= energy / inCells;
    Eigen::VectorXi label(count);
    for (Index i = 0; i < count; ++i) label[i] = mesh.components.label[centres[i]];
    coarse.laplacian.constants =
        ConstantModes({std::move(label), mesh.components.count}, coarse.laplacian.D);
    return coarse;
}

}  // namespace spectral
