#include "core/analysis/surface_texture.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/analysis/coarse_surface.h"
#include "core/analysis/evaluated_part.h"
#include "core/analysis/form_fit.h"
#include "core/filter/full_spectrum_evaluator.h"
#include "core/laplacian/vertex_weight.h"
#include "core/mesh/normals.h"
#include "core/support/errors.h"
#include "core/support/frequency.h"
#include "core/support/threads.h"
#include "core/transfer/transfer_function.h"

namespace spectral {

namespace {

std::optional<ShapeKind> shapeKind(FormKind form) {
    if (form == FormKind::Plane) return ShapeKind::Plane;
    if (form == FormKind::Sphere) return ShapeKind::Sphere;
    if (form == FormKind::Cylinder) return ShapeKind::Cylinder;
    return {};
}

double formSizeOf(const TextureOptions& options) {
    return options.formSize > 0.0 ? options.formSize : kFormPerWaviness * options.waviness;
}

void checkOptions(const TextureOptions& options) {
    if (!(options.waviness > 0.0 || (isShape(options.form) && options.waviness == 0.0)) ||
        !std::isfinite(options.waviness))
        throw InvalidOption("waviness = " + textOf(options.waviness) +
                            ": must be a length above zero, the cutoff of the L-filter");
    if (!(options.noise >= 0.0 && std::isfinite(options.noise)) ||
        (options.waviness > 0.0 && options.noise >= options.waviness))
        throw InvalidOption("noise = " + textOf(options.noise) +
                            ": must be a length below waviness = " + textOf(options.waviness) +
                            ", or 0 for no S-filter");
    if (options.form == FormKind::Size &&
        !(formSizeOf(options) > options.waviness && std::isfinite(formSizeOf(options))))
        throw InvalidOption("form_size = " + textOf(options.formSize) +
                            ": must be a length above waviness = " + textOf(options.waviness) +
                            ", or 0 for eight times that");
    if (!(options.creaseAngle >= 0.0 && options.creaseAngle <= 180.0))
        throw InvalidOption("crease_angle = " + textOf(options.creaseAngle) +
                            ": must be between 0 and 180 degrees");
    checkWeights({options.selected, {}});
}

/// The low-pass of ISO 16610-61 with a nesting index, exp(-pi (alpha size / wavelength)^2) with
/// alpha = sqrt(ln 2 / pi): 2^-(size / wavelength)^2. Ours is 2^(-w^2 / 2), w = feature size /
/// wavelength, and so the same for a feature size of sqrt(2) nesting indices.
TransferFunction standardGaussian(double size) {
    return {{}, cutoffFrequency(std::sqrt(2.0) * size)};
}

/// Low-passes of a signal at a nesting index, and at a smaller one if that is not 0: fractional
/// powers of one Gaussian. In the order {larger, smaller}; the smallest of all is the signal.
Evaluation lowPasses(const Laplacian& laplacian, const Eigen::MatrixXd& X, double size,
                     double smaller, double accuracy, const Progress& progress) {
    const TransferFunction F = standardGaussian(size);
    std::vector<double> powers{1.0};
    if (smaller > 0.0) powers.push_back(std::pow(smaller / size, 2));
    Evaluation done = FullSpectrumEvaluator(F, accuracy, false, Solver::Cheapest)
                          .evaluate(laplacian, X, powers, accuracy, progress);
    if (smaller == 0.0) done.Y.push_back(X);
    return done;
}

/// The low-pass of signals at a form size: on cells a sixteenth of it in size, as form varies so
/// slowly, and then over the steps between them.
/// @param smooth  n x 3, the surface without roughness.
/// @param X       n x c signals.
Eigen::MatrixXd slowParts(const MeshLaplacian& mesh, const Vertices& smooth,
                          const Eigen::MatrixXd& X, double size, const Progress& progress) {
    constexpr double kCells = 16.0, kStep = 2.0;  // cells in a size, and in what smooths steps
    constexpr Index kFewer = 4;                   // cells are worth it if there are so many fewer
    constexpr double kAccuracy = 1e-4;            // of what is a correction
    const Laplacian& laplacian = mesh.laplacian;
    const double step = kStep * size / kCells;
    const CoarseSurface coarse = coarsened(mesh, smooth, size / kCells);
    if (kFewer * coarse.laplacian.D.size() > laplacian.D.size())
        return lowPasses(laplacian, X, size, 0.0, kAccuracy, progress).Y[0];
    const auto columns = [](const Eigen::MatrixXd& in, Index rows, const auto& map) {
        Eigen::MatrixXd out(rows, in.cols());
        for (Index c = 0; c < in.cols(); ++c) out.col(c) = map(Eigen::VectorXd(in.col(c)));
        return out;
    };
    const Eigen::MatrixXd means =
        columns(X, coarse.laplacian.D.size(),
                [&](const Eigen::VectorXd& x) { return coarse.meansOf(x, laplacian.D); });
    const Evaluation form = lowPasses(coarse.laplacian, means, std::sqrt(size * size - step * step),
                                      0.0, kAccuracy, progress);
    const Eigen::MatrixXd steps = columns(
        form.Y[0], X.rows(), [&](const Eigen::VectorXd& x) { return coarse.constantIn(x); });
    return lowPasses(laplacian, steps, step, 0.0, kAccuracy, progress).Y[0];
}

/// The low-pass of heights at a form size, a mean over those that are far from ends: heights at
/// creases are far larger, and would draw the form of the flanks with them.
Eigen::VectorXd formOf(const Eigen::VectorXd& h, const std::vector<bool>& isFar,
                       const MeshLaplacian& mesh, const Vertices& smooth, double size,
                       const Progress& progress) {
    constexpr double kLeast = 0.01;  // weight that still has a mean; the low-pass is 1e-4 off
    if (std::count(isFar.begin(), isFar.end(), false) == 0)
        return slowParts(mesh, smooth, h, size, progress).col(0);
    Eigen::MatrixXd weighted(h.size(), 2);
    for (Index i = 0; i < h.size(); ++i)
        weighted.row(i) << (isFar[i] ? h[i] : 0.0), (isFar[i] ? 1.0 : 0.0);
    // Columns of one size: the accuracy is that of all of them together.
    const double scale = weighted.col(0).norm() / weighted.col(1).norm();
    if (scale == 0.0) return Eigen::VectorXd::Zero(h.size());
    weighted.col(1) *= scale;
    const Eigen::MatrixXd slow = slowParts(mesh, smooth, weighted, size, progress);
    return slow.col(0).cwiseQuotient((slow.col(1) / scale).cwiseMax(kLeast));
}

/// What is left of a signal by the S- and L-filters, its reference, and how accurately.
struct Separated {
    Eigen::MatrixXd waviness;  ///< The signal without noise and roughness; 0 without an L-filter.
    Eigen::MatrixXd roughness;
    double errorEstimate = 0.0;  ///< Root mean square, units of the signal.
    bool accuracyReached = true;
};

Separated separated(const Laplacian& laplacian, const Eigen::MatrixXd& X,
                    const TextureOptions& options, const Progress& progress) {
    const bool hasWaviness = options.waviness > 0.0;
    if (!hasWaviness && options.noise == 0.0) return {Eigen::MatrixXd::Zero(X.rows(), X.cols()), X};
    const Evaluation done =
        hasWaviness
            ? lowPasses(laplacian, X, options.waviness, options.noise, kTextureAccuracy, progress)
            : lowPasses(laplacian, X, options.noise, 0.0, kTextureAccuracy, progress);
    const double size =
        std::sqrt((laplacian.D.asDiagonal() * X.cwiseAbs2()).sum() / laplacian.D.sum());
    Separated parts{done.Y[0], {}, done.errorEstimate * size, done.accuracyReached};
    if (hasWaviness) {
        parts.roughness = done.Y[1] - done.Y[0];
    } else {
        parts.roughness = done.Y[0];
        parts.waviness.setZero();
    }
    return parts;
}

/// Unit normals; 0 where the surface has shrunk to a point.
Vertices unitNormals(const Vertices& X, const Faces& F) {
    Vertices N = angleWeightedNormals<double>(X, F).vertices;
    N.rowwise().normalize();  // leaves zeros
    return N.array().isFinite().select(N, 0.0);
}

/// Heights, and what they stand on.
struct Heights {
    Eigen::VectorXd h;
    Vertices reference;
    double formRadius = 0.0;
    double errorEstimate = 0.0;
    bool accuracyReached = true;
};

Heights heightsAboveShape(ShapeKind kind, const MeshLaplacian& mesh,
                          const std::vector<bool>& evaluated, const TextureOptions& options,
                          const Progress& progress) {
    const Vertices& X = mesh.surface.X;
    const Eigen::VectorXd counts =
        Eigen::VectorXd::NullaryExpr(X.rows(), [&](Index i) { return evaluated[i] ? 1.0 : 0.0; });
    const Vertices normals = unitNormals(X, mesh.surface.F);
    FittedShape shape = fitShape(kind, X, normals, mesh.laplacian.D.cwiseProduct(counts));
    if (kind == ShapeKind::Plane) {
        // Again by areas of the plane, as all means are: steep parts of the surface have larger
        // ones. Seen from a centre or an axis near it, parts far from the shape would weigh most.
        const auto [d, N] = shape.distancesOf(X);
        const Eigen::VectorXd areas = lumpedMass(X - d.asDiagonal() * N, mesh.surface.F);
        shape = fitShape(kind, X, normals, areas.cwiseProduct(counts));
    }
    const auto [d, N] = shape.distancesOf(X);
    const Separated parts = separated(mesh.laplacian, d, options, progress);
    Heights heights;
    heights.h = parts.roughness.col(0);
    heights.reference = X + ((parts.waviness.col(0) - d).asDiagonal() * N);
    heights.formRadius = shape.radius;
    heights.errorEstimate = parts.errorEstimate;
    heights.accuracyReached = parts.accuracyReached;
    return heights;
}

Heights heightsAboveLowPass(const MeshLaplacian& mesh, const std::vector<bool>& isFar,
                            const TextureOptions& options, const Progress& progress) {
    const Separated parts = separated(mesh.laplacian, mesh.surface.X, options, progress);
    Heights heights;
    heights.reference = parts.waviness;
    heights.errorEstimate = parts.errorEstimate;
    heights.accuracyReached = parts.accuracyReached;
    const Vertices N = unitNormals(heights.reference, mesh.surface.F);
    heights.h = parts.roughness.cwiseProduct(N).rowwise().sum();
    if (options.form == FormKind::None) return heights;
    heights.h -= formOf(heights.h, isFar, mesh, heights.reference, formSizeOf(options), progress);
    return heights;
}

/// Whether parts are thinner than a low-pass: around a cylinder with a circumference of .7 cutoffs
/// it leaves a quarter of the area, as of a sphere of one cutoff.
std::vector<bool> thinParts(const MeshLaplacian& mesh, const Vertices& reference) {
    constexpr double kThin = 0.25;
    const Eigen::VectorXd areas = lumpedMass(reference, mesh.surface.F);
    std::vector<bool> thin(static_cast<std::size_t>(areas.size()));
    for (Index i = 0; i < areas.size(); ++i) thin[i] = areas[i] < kThin * mesh.laplacian.D[i];
    return thin;
}

int countOf(const std::vector<bool>& flags) {
    return static_cast<int>(std::count(flags.begin(), flags.end(), true));
}

}  // namespace

SurfaceTexture surfaceTexture(const Vertices& V, const Faces& F, const TextureOptions& options,
                              const Progress& progress) {
    checkOptions(options);
    const ThreadTeam team(progress);
    const MeshLaplacian mesh = meshLaplacian(V, F, options.laplacian);
    std::vector<bool> evaluated(mesh.surface.vertex.size(), true);
    if (!options.selected.empty()) evaluated = selectedOn(mesh.surface, options.selected);
    const int selected = countOf(evaluated);
    const double cutoff = options.waviness > 0.0 ? options.waviness : options.noise;
    const std::vector<bool> isFar =
        farFromEnds(mesh.surface, mesh.laplacian.W, options.creaseAngle, cutoff);
    for (std::size_t i = 0; i < evaluated.size(); ++i) evaluated[i] = evaluated[i] && isFar[i];
    const int count = countOf(evaluated);
    if (count == 0)
        throw InvalidOption("waviness = " + textOf(cutoff) +
                            ": the whole surface is within this distance of its boundary or of "
                            "creases. Choose a smaller one, or a larger crease_angle");

    const std::optional<ShapeKind> kind = shapeKind(options.form);
    Heights heights = kind ? heightsAboveShape(*kind, mesh, evaluated, options, progress)
                           : heightsAboveLowPass(mesh, isFar, options, progress);
    SurfaceTexture texture;
    const std::vector<bool> thin =
        kind ? std::vector<bool>(evaluated.size()) : thinParts(mesh, heights.reference);
    for (std::size_t i = 0; i < evaluated.size(); ++i) {
        if (!evaluated[i] || !thin[i]) continue;
        evaluated[i] = false;
        if (texture.tooThin++ == 0) texture.firstTooThin = static_cast<int>(mesh.surface.vertex[i]);
    }
    if (texture.tooThin == count)
        throw InvalidOption("waviness = " + textOf(cutoff) +
                            ": all that could be measured is thinner than this, choose a smaller "
                            "one");
    static_cast<TextureParameters&>(texture) =
        textureParameters(heights.h, heights.reference, mesh.surface.F, evaluated);
    for (Index i = 0; i < heights.h.size(); ++i)
        if (!evaluated[i]) heights.h[i] = 0.0;
    texture.height = extended(heights.h, mesh.surface, V.rows());
    texture.evaluated = count - texture.tooThin;
    texture.leftOut = selected - count;
    texture.formRadius = heights.formRadius;
    texture.errorEstimate = heights.errorEstimate;
    texture.accuracyReached = heights.accuracyReached;
    return texture;
}

}  // namespace spectral
