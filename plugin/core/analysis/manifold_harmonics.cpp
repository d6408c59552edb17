#include "core/analysis/manifold_harmonics.h"

#include <cmath>
#include <string>
#include <utility>

#include "core/harmonics/harmonic_basis.h"
#include "core/harmonics/truncated_basis.h"
#include "core/laplacian/constant_modes.h"
#include "core/laplacian/interior.h"
#include "core/laplacian/mesh_laplacian.h"
#include "core/ldlt/cholesky.h"
#include "core/mesh/mesh.h"
#include "core/support/errors.h"

namespace spectral {

namespace {

/// Relative difference of absolute values that are taken for equal: well above the accuracy of an
/// eigenvector, well below what tells entries apart where there is no symmetry.
constexpr double kTie = 1e-6;

void checkBasisSize(int k, const Interior& interior) {
    const std::string given = "basis_size = " + std::to_string(k);
    const Index vertices = interior.size();
    const int components = interior.components().count;
    const char* const where =
        interior.isWhole() ? "the surface has " : "beside its fixed boundary the surface has ";
    if (vertices < 2)
        throw InvalidOption(std::string("boundary = fixed leaves nothing that could vibrate: ") +
                            where + std::to_string(vertices) + " vertices. Choose boundary = free");
    if (k >= vertices)
        throw InvalidOption(given + " needs more than " + std::to_string(k) + " vertices; " +
                            where + std::to_string(vertices) + ": choose at most " +
                            std::to_string(vertices - 1));
    if (k < 1) throw InvalidOption(given + ": choose at least " + std::to_string(components + 1));
    if (k <= components)
        throw InvalidOption(given +
                            " leaves no room beside the constant modes, of which every "
                            "connected component has one that no boundary holds (here " +
                            std::to_string(components) + "): choose at least " +
                            std::to_string(components + 1));
}

}  // namespace

void fixSigns(Eigen::MatrixXd& Phi) {
    for (Index j = 0; j < Phi.cols(); ++j) {
        const double extreme = Phi.col(j).cwiseAbs().maxCoeff();
        Index first = 0;
        while (first < Phi.rows() && std::abs(Phi(first, j)) < (1.0 - kTie) * extreme) ++first;
        if (first < Phi.rows() && Phi(first, j) < 0.0) Phi.col(j) *= -1.0;
    }
}

ManifoldHarmonics manifoldHarmonics(const Vertices& V, const Faces& F,
                                    const HarmonicsOptions& options, const Progress& progress) {
    const MeshLaplacian mesh = meshLaplacian(V, F, options.laplacian);
    const Interior interior(mesh.surface.F, mesh.components, options.boundary);
    const Index k = options.basisSize;
    checkBasisSize(options.basisSize, interior);

    const Laplacian laplacian = interior.restricted(mesh.laplacian);
    const ConstantModes constants(interior.components(), laplacian.D);
    ShiftedCholesky cholesky;
    HarmonicBasis basis = truncatedBasis(laplacian, constants, k, cholesky, progress);
    ManifoldHarmonics harmonics;
    harmonics.wholeSize = static_cast<int>(basis.size());
    basis.Phi.conservativeResize(Eigen::NoChange, k);
    fixSigns(basis.Phi);
    harmonics.lambda = basis.lambda.head(k);
    harmonics.residuals = basis.residuals.head(k);
    harmonics.inertiaCount = static_cast<int>(basis.inertiaCount);
    harmonics.Phi = onMesh(mesh.surface, interior.extended(std::move(basis.Phi)), V.rows());
    return harmonics;
}

}  // namespace spectral
