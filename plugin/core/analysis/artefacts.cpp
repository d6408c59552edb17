#include "core/analysis/artefacts.h"

#include <cmath>

#include "core/krylov/full_spectrum.h"
#include "core/krylov/pole_selection.h"
#include "core/support/frequency.h"
#include "core/support/threads.h"

namespace spectral {

double artefactFreeGain(double omega, double cutoff) {
    const double x = omega / (2.0 * cutoff);  // lambda / (4 lambda_c) = x^2
    return 1.0 / (1.0 + std::pow(x, 8));
}

Artefacts measureArtefacts(const Vertices& V, const Faces& F, const ArtefactOptions& options,
                           const Progress& progress) {
    // Relative to the size of the shape. In good results artefacts are 1e-4 of it: four digits.
    constexpr double kAccuracy = 1e-8;
    const ThreadTeam team(progress);
    const MeshLaplacian mesh = meshLaplacian(V, F, options.laplacian);
    const double cutoff = cutoffFrequency(options.featureSize);
    const Gain gain = [cutoff](double omega) { return artefactFreeGain(omega, cutoff); };
    const Eigen::VectorXd& D = mesh.laplacian.D;

    progress.report(0.0, "factorizing");
    ShiftedLdlt ldlt;
    ldlt.factorizeDefinite(mesh.laplacian.W, D,
                           selectPole(gain, 2.0 * cutoff, bulkSpectrum(mesh.laplacian), kAccuracy));
    FullSpectrumOptions evaluation;
    evaluation.accuracy = kAccuracy;
    evaluation.roundOffAtVertices = roundOffAtVertices(ldlt, mesh.laplacian);
    const Vertices& X = mesh.surface.X;
    const FullSpectrumResult smooth =
        applyFullSpectrum(mesh.laplacian, ShiftInvert(ldlt), {gain}, X, evaluation, progress)
            .front();

    const Eigen::VectorXd length = (X - smooth.Y).rowwise().norm();
    Artefacts artefacts;
    artefacts.rms = std::sqrt(length.cwiseAbs2().dot(D) / D.sum());
    artefacts.maximum = length.maxCoeff();
    artefacts.length = extended(length, mesh.surface, V.rows());
    artefacts.errorEstimate = smooth.errorEstimate * X.cwiseAbs().maxCoeff();
    return artefacts;
}

}  // namespace spectral
