#include "basis_certificate.h"

#include <algorithm>

#include "errors.h"
#include "mass_products.h"
#include "parallel_tasks.h"
#include "symmetric_product.h"

namespace spectral {

namespace {

/// Neighbours below whose overlaps are looked at, at least: those of harmonics with distinct
/// eigenvalues are bound by their residuals.
constexpr Index kNeighbours = 16;

/// Harmonics that one task looks at.
constexpr Index kColumns = 16;

/// Neighbouring eigenvalues nearer than this part of the mean spacing lambda_k / k (Weyl's law)
/// belong to one cluster: equal ones by symmetry, told apart by the mesh or by round-off only.
constexpr double kClusterSpacing = 0.1;

}  // namespace

std::optional<Index> cutOutsideClusters(const Eigen::VectorXd& lambda, Index asked) {
    const double spacing = lambda[asked - 1] / static_cast<double>(asked);
    for (Index k = asked; k < lambda.size(); ++k)
        if (lambda[k] - lambda[k - 1] > kClusterSpacing * spacing) return k;
    return std::nullopt;
}

void measureBasis(const Laplacian& laplacian, Index constants, HarmonicBasis& basis,
                  const std::function<void()>& beside, const Progress& progress) {
    const Index k = basis.size();
    Eigen::VectorXd overlaps(k);
    basis.residuals = Eigen::VectorXd::Zero(k);
    const auto measure = [&](Index begin, const StopPoint& stopPoint) {
        stopPoint();
        const Index end = std::min(k, begin + kColumns);
        const Index first = std::max<Index>(0, begin - kNeighbours);
        Eigen::MatrixXd gram = innerProducts(basis.Phi.middleCols(first, end - first), laplacian.D,
                                             basis.Phi.middleCols(begin, end - begin));
        gram.bottomRows(end - begin).diagonal().array() -= 1.0;
        overlaps.segment(begin, end - begin) = gram.cwiseAbs().colwise().maxCoeff();
        stopPoint();
        const Index own = std::max(begin, constants), count = end - own;
        if (count <= 0) return;
        const auto lambda = basis.lambda.segment(own, count);
        basis.residuals.segment(own, count) =
            squaredResiduals(laplacian, basis.Phi.middleCols(own, count), lambda)
                .cwiseSqrt()
                .cwiseQuotient(lambda);
    };
    runInParallel(
        1 + (k + kColumns - 1) / kColumns,
        [&](Index task, int, const StopPoint& stopPoint) {
            if (task > 0) return measure((task - 1) * kColumns, stopPoint);
            if (beside) beside();
        },
        progress, "checking the harmonics");
    basis.largestOverlap = overlaps.maxCoeff();
    if (!basis.residuals.allFinite() || !overlaps.allFinite())
        throw SolverFailure(
            "the harmonics are not finite numbers: the mesh probably has degenerate "
            "triangles ('Remove Zero Area Faces')");
}

}  // namespace spectral
