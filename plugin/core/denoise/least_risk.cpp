#include "core/denoise/least_risk.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/denoise/linear_steps.h"
#include "core/graph/diffusion.h"
#include "core/noise/noise_estimate.h"
#include "core/support/dense_solvers.h"

namespace spectral {

namespace {

constexpr int kDegree = 16;

constexpr int kProbes = 5;
using Rows = Probed<kProbes>;
using Row = Eigen::Matrix<double, 1, 3 + kProbes>;
using Basis = Eigen::Matrix<double, Eigen::Dynamic, kDegree>;

/// Calls visit(j, (T_j(P) - 1) X), j from 1 to kDegree.
template <class Visit>
void forEachPolynomial(const VertexGraph& graph, const Rows& X, const Visit& visit) {
    Rows before = X, here = X, next = X;
    for (int j = 1; j <= kDegree; ++j) {
        next = j == 1 ? X : Rows(2.0 * here - before);  // of vertices that may not move
        forEachMean(graph, here, [&](Index i, const auto& mean) {
            next.row(i) = j == 1 ? Row(mean) : Row(2.0 * mean - before.row(i));
        });
        visit(j, Rows(next - X));
        before.swap(here);
        here.swap(next);
    }
}

}  // namespace

Points withLeastRisk(const FaceGraph& graph, const Points& X, const std::vector<bool>& mayMove,
                     double height) {
    // Residuals along the surface are those of noise in all directions if they are as high as those
    // along the normals, in each direction of space.
    constexpr double kLeastAlike = 0.8, kMostAlike = 1.3;
    constexpr int kBlurs = 2;
    constexpr double kMaxTaken = 0.97;
    constexpr double kSingular = 1e-10;
    const VertexGraph averaged = averagedNeighbours(graph, graph.vertices, mayMove);
    const Points N = smoothVertexNormals(graph, X, kBlurs);
    const Index n = X.rows();
    const Rows start = withProbes<kProbes>(X);

    Basis along(n, kDegree);
    Eigen::VectorXd trace(kDegree);
    double whiteSquares = 0.0;
    Eigen::Matrix3d squares;
    forEachPolynomial(averaged, start, [&](int j, const Rows& change) {
        along.col(j - 1) = change.leftCols<3>().cwiseProduct(N).rowwise().sum();
        trace[j - 1] =
            change.rightCols<kProbes>().cwiseProduct(start.rightCols<kProbes>()).sum() / kProbes;
        if (j > 1) return;
        squares = change.leftCols<3>().transpose() * change.leftCols<3>();
        whiteSquares = change.rightCols<kProbes>().squaredNorm() / kProbes;
    });
    const double variance = height * height;
    const Eigen::VectorXd c =
        leastNormSolution(along.transpose() * along, -variance * trace, kSingular);
    const Eigen::VectorXd change = along * c;
    // What is taken away is lower than the noise; if not, the given height is that of the shape.
    const double taken =
        change.norm() / (height * std::sqrt(static_cast<double>(std::max<Index>(n, 1))));
    const double share = std::pow(std::min(1.0, kMaxTaken / taken), 2);
    Points moved = X + (share * change).asDiagonal() * N;

    const Eigen::Array3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(squares)
                                    .eigenvalues()
                                    .array()
                                    .max(0.0)
                                    .sqrt() /
                                (height * std::sqrt(whiteSquares));
    const double tangential =
        std::sqrt((squares.trace() - along.col(0).squaredNorm()) / 2.0 / whiteSquares) / height;
    if (!(std::min(axes[0], tangential) > kLeastAlike && tangential < kMostAlike)) return moved;

    std::vector<Points> parts;
    forEachPolynomial(averaged, start, [&](int j, const Rows& all) {
        parts.emplace_back(all.leftCols<3>() - along.col(j - 1).asDiagonal() * N);
    });
    Eigen::MatrixXd gram(kDegree, kDegree);
    for (int j = 0; j < kDegree; ++j)
        for (int k = 0; k <= j; ++k)
            gram(j, k) = gram(k, j) = parts[j].cwiseProduct(parts[k]).sum();
    const Eigen::VectorXd d = leastNormSolution(gram, -2.0 * variance * trace, kSingular);
    for (int j = 0; j < kDegree; ++j) moved += share * d[j] * parts[j];
    return moved;
}

}  // namespace spectral
