#include "core/analysis/artefacts.h"

#include <cmath>

#include "core/krylov/full_spectrum.h"
#include "core/krylov/pole_selection.h"
#include "core/laplacian/frequency.h"
#include "core/laplacian/mesh_laplacian.h"
#include "core/ldlt/cholesky.h"
#include "core/mesh/mesh.h"
#include "core/support/thread_team.h"

namespace spectral {

namespace {

/// Relative to the shape's size: good results are smooth to 1e-4 of it, and that is to be told
/// exactly.
constexpr double kAccuracy = 1e-8;

}  // namespace

double artefactFreeGain(double omega, double cutoff) {
    const double x = omega / (2.0 * cutoff);  // lambda / (4 lambda_c) = x^2
    return 1.0 / (1.0 + std::pow(x, 8));
}

Artefacts measureArtefacts(const Vertices& V, const Faces& F, const ArtefactOptions& options,
                           const Progress& progress) {
    const ThreadTeam team;
    const MeshLaplacian mesh = meshLaplacian(V, F, options.laplacian);
    const double cutoff = cutoffFrequency(options.featureSize);
    const Gain gain = [cutoff](double omega) { return artefactFreeGain(omega, cutoff); };
    const Eigen::VectorXd& D = mesh.laplacian.D;

    progress.report(0.0, "factorizing");
    ShiftedCholesky cholesky;
    // The gain turns over at twice the cutoff.
    cholesky.factorize(
        mesh.laplacian,
        selectPole(gain, 2.0 * cutoff, bulkSpectrum(mesh.laplacian), kAccuracy).shift);
    FullSpectrumOptions evaluation;
    evaluation.accuracy = kAccuracy;
    const Vertices& X = mesh.surface.X;
    const FullSpectrumResult smooth =
        applyFullSpectrum(D, mesh.constants, cholesky, gain, X, evaluation, progress);

    const Eigen::VectorXd length = (X - smooth.Y).rowwise().norm();
    Artefacts artefacts;
    artefacts.rms = std::sqrt(length.cwiseAbs2().dot(D) / D.sum());
    artefacts.maximum = length.maxCoeff();
    artefacts.length = onMesh(mesh.surface, length, V.rows());
    artefacts.errorEstimate = smooth.errorEstimate * X.cwiseAbs().maxCoeff();
    return artefacts;
}

}  // namespace spectral
