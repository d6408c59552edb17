#include "core/analysis/manifold_harmonics.h"

#include <cmath>
#include <string>
#include <utility>

#include "core/harmonics/truncated_basis.h"
#include "core/support/errors.h"
#include "core/support/threads.h"

namespace spectral {

void fixSigns(Eigen::MatrixXd& Phi) {
    // Relative difference below which entries count as equal: well above the error of an
    // eigenvector, well below the differences on a mesh without symmetry.
    constexpr double kTie = 1e-6;
    for (Index j = 0; j < Phi.cols(); ++j) {
        const double extreme = Phi.col(j).cwiseAbs().maxCoeff();
        Index first = 0;
        while (first < Phi.rows() && std::abs(Phi(first, j)) < (1.0 - kTie) * extreme) ++first;
        if (first < Phi.rows() && Phi(first, j) < 0.0) Phi.col(j) *= -1.0;
    }
}

ManifoldHarmonics manifoldHarmonics(const Vertices& V, const Faces& F,
                                    const HarmonicsOptions& options, const Progress& progress) {
    const ThreadTeam team(progress);
    const MeshLaplacian mesh = meshLaplacian(V, F, options.laplacian);
    const Interior interior(mesh.surface.F, mesh.components, options.boundary);
    const Index k = options.basisSize;
    if (interior.size() < 2)
        throw InvalidOption(ErrorCode::BoundaryFixesAll, "boundary = fixed leaves " +
                                                             std::to_string(interior.size()) +
                                                             " vertices, too few for a harmonic");

    const Laplacian laplacian = interior.restricted(mesh.laplacian);
    ShiftedLdlt ldlt;
    // Kovnatsky et al. 2012, Eq. 4: W phi = lambda D phi.
    HarmonicBasis basis = truncatedBasis(laplacian, k, ldlt, progress);
    ManifoldHarmonics harmonics;
    harmonics.wholeSize = static_cast<int>(basis.size());
    basis.Phi.conservativeResize(Eigen::NoChange, k);
    fixSigns(basis.Phi);
    harmonics.lambda = basis.lambda.head(k);
    harmonics.residuals = basis.residuals.head(k);
    harmonics.inertiaCount = static_cast<int>(basis.inertiaCount);
    harmonics.Phi = extended(interior.extended(std::move(basis.Phi)), mesh.surface, V.rows());
    return harmonics;
}

}  // namespace spectral
