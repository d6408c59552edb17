#include "core/analysis/surface_texture.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/krylov/full_spectrum.h"
#include "core/krylov/pole_selection.h"
#include "core/laplacian/interior.h"
#include "core/laplacian/vertex_weight.h"
#include "core/mesh/creases.h"
#include "core/mesh/normals.h"
#include "core/support/errors.h"
#include "core/support/frequency.h"
#include "core/support/threads.h"

namespace spectral {

namespace {

// Relative to the size of the shape, of which roughness is a thousandth.
constexpr double kAccuracy = 1e-8;

void checkOptions(const TextureOptions& options) {
    if (!(options.waviness > 0.0) || !std::isfinite(options.waviness))
        throw InvalidOption("waviness = " + textOf(options.waviness) +
                            ": must be a length above zero, the cutoff of the L-filter");
    if (!(options.noise >= 0.0 && options.noise < options.waviness))
        throw InvalidOption("noise = " + textOf(options.noise) +
                            ": must be a length below waviness = " + textOf(options.waviness) +
                            ", or 0 for no S-filter");
    if (options.form != 0.0 && !(options.form > options.waviness && std::isfinite(options.form)))
        throw InvalidOption("form = " + textOf(options.form) +
                            ": must be a length above waviness = " + textOf(options.waviness) +
                            ", or 0 for eight times that");
    if (!(options.creaseAngle >= 0.0 && options.creaseAngle <= 180.0))
        throw InvalidOption("crease_angle = " + textOf(options.creaseAngle) +
                            ": must be between 0 and 180 degrees");
}

/// Low-passes of signals X at several sizes, from one Krylov space with the pole of the largest.
std::vector<FullSpectrumResult> lowPasses(const Laplacian& laplacian, const Eigen::MatrixXd& X,
                                          const MeshLaplacian& mesh,
                                          const std::vector<double>& sizes,
                                          const Progress& progress) {
    std::vector<Gain> gains;
    for (const double size : sizes)
        gains.emplace_back([size](double omega) { return standardGaussian(omega, size); });
    ShiftedLdlt ldlt;
    ldlt.factorizeDefinite(laplacian.W, laplacian.D,
                           selectPole(gains.back(), cutoffFrequency(sizes.back()),
                                      bulkSpectrum(mesh.laplacian), kAccuracy));
    FullSpectrumOptions evaluation;
    evaluation.accuracy = kAccuracy;
    evaluation.roundOffAtVertices = roundOffAtVertices(ldlt, laplacian);
    return applyFullSpectrum(laplacian, ShiftInvert(ldlt), gains, X, evaluation, progress);
}

/// Whether each vertex is further than a cutoff from boundaries and sharp creases: within it, the
/// low-pass averages over what is not there, or over both sides of the crease.
std::vector<bool> evaluatedVertices(const MeshLaplacian& mesh, const TextureOptions& options) {
    const Surface& surface = mesh.surface;
    std::vector<bool> ends = boundaryVertices(surface.F, surface.X.rows());
    if (options.creaseAngle < 180.0) {
        const std::vector<bool> creases = creaseVertices(surface.X, surface.F, options.creaseAngle);
        for (std::size_t i = 0; i < ends.size(); ++i) ends[i] = ends[i] || creases[i];
    }
    std::vector<bool> evaluated(ends.size(), true);
    if (std::find(ends.begin(), ends.end(), true) == ends.end()) return evaluated;
    const Eigen::VectorXd near =
        selectionWeight(mesh.laplacian, mesh.components, ends, options.waviness);
    for (std::size_t i = 0; i < ends.size(); ++i) evaluated[i] = near[static_cast<Index>(i)] == 0.0;
    return evaluated;
}

/// Heights are weighted with the vertex areas of the reference: moments of the distribution.
void measureHeights(const Eigen::VectorXd& h, const Eigen::VectorXd& areas,
                    const std::vector<bool>& evaluated, SurfaceTexture& texture) {
    double sum = 0.0, squares = 0.0, cubes = 0.0, fourths = 0.0;
    double highest = 0.0, lowest = 0.0;
    for (Index i = 0; i < h.size(); ++i) {
        if (!evaluated[i]) continue;
        texture.area += areas[i];
        sum += areas[i] * std::abs(h[i]);
        squares += areas[i] * std::pow(h[i], 2);
        cubes += areas[i] * std::pow(h[i], 3);
        fourths += areas[i] * std::pow(h[i], 4);
        highest = std::max(highest, h[i]);
        lowest = std::min(lowest, h[i]);
    }
    texture.Sa = sum / texture.area;
    texture.Sq = std::sqrt(squares / texture.area);
    texture.Sp = highest;
    texture.Sv = -lowest;
    texture.Sz = highest - lowest;
    if (texture.Sq == 0.0) return;
    texture.Ssk = cubes / texture.area / std::pow(texture.Sq, 3);
    texture.Sku = fourths / texture.area / std::pow(texture.Sq, 4);
}

/// Squared slope of a height that is linear on a triangle of the reference; -1 without area.
double squaredSlope(const Eigen::RowVector3d& a, const Eigen::RowVector3d& b, double da,
                    double db) {
    const double aa = a.squaredNorm(), ab = a.dot(b), bb = b.squaredNorm();
    const double determinant = aa * bb - ab * ab;
    if (!(determinant > 0.0)) return -1.0;
    return (bb * da * da - 2.0 * ab * da * db + aa * db * db) / determinant;
}

void measureSlopes(const Eigen::VectorXd& h, const Vertices& reference, const Faces& F,
                   const std::vector<bool>& evaluated, SurfaceTexture& texture) {
    double total = 0.0, slopes = 0.0, added = 0.0;
    for (Index t = 0; t < F.rows(); ++t) {
        const int i = F(t, 0), j = F(t, 1), k = F(t, 2);
        if (!evaluated[i] || !evaluated[j] || !evaluated[k]) continue;
        const Eigen::RowVector3d a = reference.row(j) - reference.row(i);
        const Eigen::RowVector3d b = reference.row(k) - reference.row(i);
        const double squared = squaredSlope(a, b, h[j] - h[i], h[k] - h[i]);
        if (squared < 0.0) continue;
        const double area = 0.5 * a.cross(b).norm();
        total += area;
        slopes += area * squared;
        added += area * squared / (std::sqrt(1.0 + squared) + 1.0);  // sqrt(1 + s) - 1
    }
    if (total == 0.0) return;
    texture.Sdq = std::sqrt(slopes / total);
    texture.Sdr = added / total;
}

}  // namespace

// exp(-pi (alpha size / wavelength)^2) with alpha = sqrt(ln 2 / pi) (ISO 16610-61) is
// 2^-(size / wavelength)^2, with size / wavelength = omega size / 2 pi. The low-pass of the filters
// is 2^(-w^2 / 2), w = feature size / wavelength, 3 dB at the feature size: it is this one if
// w^2 / 2 = (size / wavelength)^2, for a feature size of sqrt(2) nesting indices.
double standardGaussian(double omega, double size) {
    return std::exp2(-std::pow(omega / cutoffFrequency(size), 2));
}

SurfaceTexture surfaceTexture(const Vertices& V, const Faces& F, const TextureOptions& options,
                              const Progress& progress) {
    checkOptions(options);
    const ThreadTeam team(progress);
    const MeshLaplacian mesh = meshLaplacian(V, F, options.laplacian);
    const Vertices& X = mesh.surface.X;
    const std::vector<bool> evaluated = evaluatedVertices(mesh, options);
    SurfaceTexture texture;
    texture.evaluated = static_cast<int>(std::count(evaluated.begin(), evaluated.end(), true));
    texture.leftOut = static_cast<int>(evaluated.size()) - texture.evaluated;
    if (texture.evaluated == 0)
        throw InvalidOption("waviness = " + textOf(options.waviness) +
                            ": the whole surface is within this distance of its boundary or of "
                            "creases, choose a smaller one, or a larger crease_angle");

    std::vector<double> sizes{options.waviness};
    if (options.noise > 0.0) sizes.insert(sizes.begin(), options.noise);
    const std::vector<FullSpectrumResult> smooth =
        lowPasses(mesh.laplacian, X, mesh, sizes, progress);
    const Vertices reference = smooth.back().Y;
    const Vertices detail = (options.noise > 0.0 ? Vertices(smooth.front().Y) : X) - reference;

    Vertices normals = angleWeightedNormals<double>(reference, mesh.surface.F).vertices;
    normals.rowwise().normalize();  // leaves zeros
    // None where the reference has shrunk to a point.
    normals = normals.array().isFinite().select(normals, 0.0).eval();
    Eigen::VectorXd h = detail.cwiseProduct(normals).rowwise().sum();
    const double form = options.form > 0.0 ? options.form : kFormPerWaviness * options.waviness;
    const FullSpectrumResult offset = lowPasses(mesh.laplacian, h, mesh, {form}, progress).front();
    h -= offset.Y.col(0);

    measureHeights(h, lumpedMass(reference, mesh.surface.F), evaluated, texture);
    measureSlopes(h, reference, mesh.surface.F, evaluated, texture);
    for (Index i = 0; i < h.size(); ++i)
        if (!evaluated[i]) h[i] = 0.0;
    texture.height = extended(h, mesh.surface, V.rows());
    texture.accuracyReached = offset.converged;
    for (const FullSpectrumResult& one : smooth) {
        texture.accuracyReached = texture.accuracyReached && one.converged;
        texture.errorEstimate =
            std::max(texture.errorEstimate, one.errorEstimate * X.cwiseAbs().maxCoeff());
    }
    return texture;
}

}  // namespace spectral
