#include "fuzz/accuracy.h"

#include <algorithm>
#include <cmath>

#include "core/analysis/bands.h"
#include "core/mesh/contacts.h"
#include "core/mesh/measures.h"
#include "core/support/frequency.h"
#include "fuzz/dense_reference.h"

namespace spectral::fuzz {

namespace {

/// Largest number of vertices with a reference, whose time is cubic.
constexpr Index kMaxVertices = 420;

/// Errors above this multiple of the claimed accuracy are failures.
constexpr double kLeeway = 3.0;

/// Uncertainty of a reference, as a multiple of its difference from the perturbed ones.
constexpr double kUncertainty = 10.0;

/// Round-off of a filter, from its solves: relative to the diagonal, in the norm over the surface.
constexpr double kSurfaceRoundOff = 1e-12;

/// A vector with a larger residual is not a harmonic.
constexpr double kUselessResidual = 1e-2;

/// Compares a result with a reference, first in double precision and, if necessary, in extended
/// precision, three times.
/// @param ofReference  maps a DenseSpectrum to a matrix of the size of `computed`.
/// @param size         norm of a difference of two such matrices.
/// @param verdict      gets a failure if the error exceeds `tolerance` beyond uncertainty.
template <class OfReference, class Size>
void compare(const char* kind, const Eigen::MatrixXd& computed, double tolerance, double unit,
             DenseReference& reference, const OfReference& ofReference, const Size& size,
             Verdict& verdict) {
    verdict.isCompared = true;
    const auto error = [&](Precision precision) {
        return size(computed - ofReference(reference.at(precision)));
    };
    if (error(Precision::Double) <= tolerance) return;
    const double exact = error(Precision::Extended);
    if (exact <= tolerance) return;
    double unknown = 0.0;
    for (const Precision perturbed : {Precision::Perturbed, Precision::PerturbedAgain})
        unknown = std::max(unknown, size(ofReference(reference.at(perturbed)) -
                                         ofReference(reference.at(Precision::Extended))));
    if (!(exact > tolerance + kUncertainty * unknown)) {
        verdict.isExcused = true;
        return;
    }
    verdict.failures.push_back(failure(kind, "error ", exact / unit, ", allowed ", tolerance / unit,
                                       ", uncertainty of the reference ", unknown / unit));
}

/// F at all frequencies of the reference.
Eigen::VectorXd gainsOf(const FilterOptions& options, const FilterResult& result,
                        const Eigen::VectorXd& lambda) {
    const TransferFunction F(options.transferFunction, result.cutoffFrequency);
    const Eigen::VectorXd omega = lambda.cwiseSqrt();
    Eigen::VectorXd gains = omega.unaryExpr([&F](double w) { return F(w); });
    if (options.evaluation.spectrum != Spectrum::Truncated) return gains;
    const Index k = result.eigenvalues.size(), beyond = omega.size() - k;
    double residual = 0.0;
    if (options.evaluation.truncation.reinjectResidual) {
        const TransferFunction whole = F.whole();
        const double from = omega[k - 1], to = omega[omega.size() - 1];
        residual = std::pow(from < to ? meanGain(whole, from, to) : whole(to), F.appliedPower());
    }
    gains.tail(beyond).setConstant(residual);
    return gains;
}

double largestRow(const Eigen::MatrixXd& X) { return X.rowwise().norm().maxCoeff(); }

/// Rows of the vertices of the interior.
Eigen::MatrixXd interiorRows(const DenseReference& reference, const Eigen::MatrixXd& ofMesh) {
    const std::vector<Index>& vertex = reference.mesh().surface.vertex;
    return reference.interior().restricted(Eigen::MatrixXd(ofMesh(vertex, Eigen::indexing::all)));
}

/// With residuals r_i = W phi_i - lambda_i D phi_i, (lambda_i - lambda_j) phi_i^T D phi_j is
/// phi_j^T r_i - phi_i^T r_j: the loss of orthogonality that residuals allow.
void checkOrthogonality(const Eigen::MatrixXd& gram, const ManifoldHarmonics& harmonics,
                        Verdict& verdict) {
    const Eigen::VectorXd norms = harmonics.residuals.cwiseProduct(harmonics.lambda);
    for (Index i = 0; i < gram.rows(); ++i)
        for (Index j = 0; j <= i; ++j) {
            const double overlap = std::abs(gram(i, j) - (i == j ? 1.0 : 0.0));
            if (overlap <= 1e-8) continue;
            const double gap = std::abs(harmonics.lambda[i] - harmonics.lambda[j]);
            if (i != j && overlap * gap <= kLeeway * (norms[i] + norms[j])) continue;
            verdict.failures.push_back(
                failure("orthogonality", "Phi^T D Phi - I has ", overlap, " at ", i, ", ", j));
            return;
        }
}

/// Whether bodies touch at vertices, which then move alike.
bool hasContacts(const MeshLaplacian& mesh) {
    Vertices distinct(mesh.surface.X.rows(), 3);
    for (Index i = 0; i < distinct.rows(); ++i)
        distinct.row(i).setConstant(1.0 + static_cast<double>(i));
    Vertices moved = distinct;
    moveContactsAlike(mesh.surface, mesh.components, moved);
    return moved != distinct;
}

}  // namespace

void compareWithDense(const testing::Mesh& mesh, const FilterOptions& options,
                      const FilterResult& result, Verdict& verdict) {
    const bool isOneStep = options.steps == 1 || options.basisUpdate == BasisUpdate::None;
    if (!isOneStep || !result.accuracyReached || mesh.V.rows() > kMaxVertices) return;
    if (!options.part.selected.empty() || options.part.weight.size() > 0 ||
        options.creaseAngle > 0.0 || options.preserveVolume)
        return;  // the reference filters whole meshes only
    DenseReference reference(mesh.V, mesh.F, options.laplacian, options.boundary);
    if (reference.size() == 0) return;
    if (hasContacts(reference.mesh())) return;  // of which the reference knows nothing

    const double diagonal = boundingBoxDiagonal(reference.mesh().surface.X);
    const double roundOff = 1e-15 * mesh.V.cwiseAbs().maxCoeff();
    const Eigen::MatrixXd moved = interiorRows(reference, result.V - mesh.V);
    const Eigen::VectorXd& D = reference.laplacian().D;
    const double area = reference.mesh().laplacian.D.sum();
    const auto change = [&](const DenseSpectrum& spectrum) {
        return spectrum.change(gainsOf(options, result, spectrum.lambda));
    };
    const bool isBasis = result.eigenvalues.size() > 0;
    double claimed = std::max(result.errorEstimate, result.accuracy);
    // A warning reports residuals above the accuracy.
    if (result.residuals.size() > 0) claimed = std::max(claimed, result.residuals.maxCoeff());
    const double tolerance =
        kLeeway * claimed * diagonal + roundOff + widestCut(mesh.V, reference.mesh().surface);
    if (options.steps > 0 || isBasis) {
        // At a vertex of small mass, round-off is larger than in the norm over the surface.
        const Eigen::VectorXd most =
            (D / area).cwiseSqrt().cwiseInverse() * (kSurfaceRoundOff * diagonal);
        const auto largest = [&](const Eigen::MatrixXd& Y) {
            return (Y.rowwise().norm() - most).maxCoeff();
        };
        compare(isBasis ? "basis accuracy" : "accuracy", moved, tolerance, diagonal, reference,
                change, largest, verdict);
        return;
    }
    // Automatic steps promise accuracy over the surface alone.
    const auto overSurface = [&](const Eigen::MatrixXd& Y) {
        return std::sqrt(Y.rowwise().squaredNorm().dot(D) / area);
    };
    compare("accuracy", moved, tolerance, diagonal, reference, change, overSurface, verdict);
}

void compareWithDense(const testing::Mesh& mesh, const ArtefactOptions& options,
                      const Artefacts& result, Verdict& verdict) {
    if (mesh.V.rows() > kMaxVertices) return;
    DenseReference reference(mesh.V, mesh.F, options.laplacian, Boundary::Free);
    const double cutoff = cutoffFrequency(options.featureSize);
    const auto lengths = [&](const DenseSpectrum& spectrum) {
        const Eigen::VectorXd gains = spectrum.lambda.cwiseSqrt().unaryExpr(
            [&](double omega) { return artefactFreeGain(omega, cutoff); });
        return Eigen::MatrixXd(spectrum.change(gains).rowwise().norm());
    };
    constexpr double kAccuracy = 1e-8;  // what measureArtefacts requests
    const double diagonal = boundingBoxDiagonal(reference.mesh().surface.X);
    compare("accuracy of artefacts", interiorRows(reference, result.length),
            kLeeway * std::max(result.errorEstimate, kAccuracy * diagonal), diagonal, reference,
            lengths, largestRow, verdict);
}

void compareWithDense(const testing::Mesh& mesh, const HarmonicsOptions& options,
                      const ManifoldHarmonics& result, Verdict& verdict) {
    DenseReference reference(mesh.V, mesh.F, options.laplacian, options.boundary);
    const Laplacian& A = reference.laplacian();
    const Eigen::MatrixXd Phi = interiorRows(reference, result.Phi);
    double copied = 0.0;  // squared norm at seams
    for (const auto& [vertex, row] : reference.mesh().surface.copies)
        copied += result.Phi.row(vertex).squaredNorm();
    if (result.Phi.squaredNorm() - copied > Phi.squaredNorm() * (1.0 + 1e-9))
        verdict.failures.push_back(failure("support", "harmonics at vertices that cannot move"));
    const Index k = Phi.cols(), constants = A.constants.count();
    checkOrthogonality(Phi.transpose() * (A.D.asDiagonal() * Phi), result, verdict);
    for (Index i = 0; i < k; ++i) {
        if (i < constants) {
            if (result.lambda[i] != 0.0)
                verdict.failures.push_back(failure("constants", "lambda ", result.lambda[i]));
            continue;
        }
        const Eigen::VectorXd r =
            A.W * Phi.col(i) - result.lambda[i] * A.D.cwiseProduct(Phi.col(i));
        const double residual = r.cwiseQuotient(A.D.cwiseSqrt()).norm() / result.lambda[i];
        if (!(residual <= kLeeway * result.residuals[i] + 1e-9)) {
            verdict.failures.push_back(
                failure("residual", residual, " instead of ", result.residuals[i], " at ", i));
            break;
        }
    }
    const double worst = result.residuals.maxCoeff();
    if (worst > kUselessResidual) {
        verdict.failures.push_back(failure("useless residual", worst));
        return;
    }
    if (reference.size() > kMaxVertices) return;
    // Relative errors, which the residuals bound.
    const auto values = [&](const DenseSpectrum& spectrum) {
        return Eigen::MatrixXd(spectrum.lambda.head(k));
    };
    const auto relative = [&](const Eigen::MatrixXd& difference) {
        double largest = 0.0;
        for (Index i = constants; i < k; ++i)
            largest = std::max(largest, std::abs(difference(i, 0)) / result.lambda[i]);
        return largest;
    };
    compare("eigenvalues", result.lambda, kLeeway * worst + 1e-7, 1.0, reference, values, relative,
            verdict);
}

void compareWithDense(const testing::Mesh& mesh, const SpectrumOptions& options,
                      const GeometrySpectrum& result, Verdict& verdict) {
    if (mesh.V.rows() > kMaxVertices) return;
    DenseReference reference(mesh.V, mesh.F, options.laplacian, options.boundary);
    const auto frequencyOf = [&](Index octave) {
        return 2.0 * kPi / result.octaveFeatureSizes[octave];
    };
    const Index count = result.octaveEnergies.size();
    const Bands bands(result.surfaceDiagonal, frequencyOf(0), frequencyOf(count - 1));
    if (bands.count() != count) {
        verdict.failures.push_back(failure("octaves", bands.count(), " instead of ", count));
        return;
    }
    const auto energies = [&](const DenseSpectrum& spectrum) {
        Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(count, 1);
        for (Index i = 0; i < spectrum.lambda.size(); ++i)
            for (int j = 0; j < count; ++j)
                sums(j, 0) += spectrum.energies[i] * bands.window(j, std::sqrt(spectrum.lambda[i]));
        return sums;
    };
    const auto largest = [](const Eigen::MatrixXd& difference) {
        return difference.cwiseAbs().maxCoeff();
    };
    const double tolerance = (1e-3 + kLeeway * result.mismatch) * result.totalEnergy;
    compare("octave energies", result.octaveEnergies, tolerance, result.totalEnergy, reference,
            energies, largest, verdict);
}

}  // namespace spectral::fuzz
