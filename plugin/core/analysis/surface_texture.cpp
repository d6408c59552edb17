#include "core/analysis/surface_texture.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/analysis/coarse_surface.h"
#include "core/analysis/evaluated_part.h"
#include "core/analysis/form_part.h"
#include "core/filter/full_spectrum_evaluator.h"
#include "core/laplacian/vertex_weight.h"
#include "core/mesh/creases.h"
#include "core/mesh/mesh_check.h"
#include "core/mesh/normals.h"
#include "core/noise/stretched_axis.h"
#include "core/support/errors.h"
#include "core/support/frequency.h"
#include "core/support/threads.h"
#include "core/support/types.h"
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

/// By how much a mesh lowers the frequencies of waves, c in omega^2 / (1 + c omega^2): as vertices
/// i are joined to j by weights w, in the mean over all directions, c_i = sum_j w |x_i - x_j|^4 /
/// (64 D_i), the next term of the series in which sum_j w |x_i - x_j|^2 / (4 D_i) = 1. Half of all
/// vertices have a larger one: faces without relief may be meshed as coarsely as you like.
double dispersionOf(const Laplacian& laplacian, const Vertices& X) {
    std::vector<double> all;
    for (Index i = 0; i < X.rows(); ++i) {
        double sum = 0.0;
        for (SparseMatrix::InnerIterator entry(laplacian.W, i); entry; ++entry)
            sum -= entry.value() * std::pow((X.row(i) - X.row(entry.index())).squaredNorm(), 2);
        all.push_back(sum / (64.0 * laplacian.D[i]));
    }
    const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
    std::nth_element(all.begin(), middle, all.end());
    return std::max(0.0, *middle);
}

/// The low-pass of ISO 16610-61 with a nesting index, exp(-pi (alpha size / wavelength)^2) with
/// alpha = sqrt(ln 2 / pi): 2^-(size / wavelength)^2. Ours is 2^(-w^2 / 2), w = feature size /
/// wavelength, and so the same for a feature size of sqrt(2) nesting indices.
TransferFunction standardGaussian(double size, double dispersion) {
    TransferFunctionOptions gaussian;
    gaussian.dispersion = dispersion;
    return {gaussian, cutoffFrequency(std::sqrt(2.0) * size)};
}

/// Low-passes of a signal at nesting indices, the largest first: fractional powers of one Gaussian.
Evaluation lowPasses(const Laplacian& laplacian, const Eigen::MatrixXd& X,
                     const std::vector<double>& sizes, double dispersion, double accuracy,
                     const Progress& progress) {
    std::vector<double> powers;
    for (const double size : sizes) powers.push_back(std::pow(size / sizes[0], 2));
    const TransferFunction F = standardGaussian(sizes[0], dispersion);
    return FullSpectrumEvaluator(F, accuracy, false, Solver::Cheapest)
        .evaluate(laplacian, X, powers, accuracy, progress);
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
        return lowPasses(laplacian, X, {size}, 0.0, kAccuracy, progress).Y[0];
    const auto columns = [](const Eigen::MatrixXd& in, Index rows, const auto& map) {
        Eigen::MatrixXd out(rows, in.cols());
        for (Index c = 0; c < in.cols(); ++c) out.col(c) = map(Eigen::VectorXd(in.col(c)));
        return out;
    };
    const Eigen::MatrixXd means =
        columns(X, coarse.laplacian.D.size(),
                [&](const Eigen::VectorXd& x) { return coarse.meansOf(x, laplacian.D); });
    const Evaluation form = lowPasses(
        coarse.laplacian, means, {std::sqrt(size * size - step * step)}, 0.0, kAccuracy, progress);
    const Eigen::MatrixXd steps = columns(
        form.Y[0], X.rows(), [&](const Eigen::VectorXd& x) { return coarse.constantIn(x); });
    return lowPasses(laplacian, steps, {step}, 0.0, kAccuracy, progress).Y[0];
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

/// Of a cutoff, squared; any other share would do.
constexpr double kBend = 0.5;

/// What is left of a signal by the S- and L-filters, its reference, and how accurately.
struct Separated {
    Eigen::MatrixXd waviness;  ///< The signal without noise and roughness; 0 without an L-filter.
    Eigen::MatrixXd roughness;
    Eigen::MatrixXd bend;  ///< What a low-pass at kBend of the cutoff leaves, but not the waviness.
    double errorEstimate = 0.0;  ///< Root mean square, units of the signal.
    bool accuracyReached = true;
};

Separated separated(const MeshLaplacian& mesh, const Eigen::MatrixXd& X,
                    const TextureOptions& options, const Progress& progress) {
    const Laplacian& laplacian = mesh.laplacian;
    std::vector<double> sizes;
    if (options.waviness > 0.0) sizes = {options.waviness, std::sqrt(kBend) * options.waviness};
    if (options.noise > 0.0) sizes.push_back(options.noise);
    const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(X.rows(), X.cols());
    if (sizes.empty()) return {none, X, none};
    const Evaluation done = lowPasses(laplacian, X, sizes, dispersionOf(laplacian, mesh.surface.X),
                                      kTextureAccuracy, progress);
    const double size =
        std::sqrt((laplacian.D.asDiagonal() * X.cwiseAbs2()).sum() / laplacian.D.sum());
    Separated parts{none, options.noise > 0.0 ? done.Y.back() : X, none, done.errorEstimate * size,
                    done.accuracyReached};
    if (options.waviness > 0.0) {
        parts.waviness = done.Y[0];
        parts.roughness -= done.Y[0];
        parts.bend = done.Y[1] - done.Y[0];
    }
    return parts;
}

/// Unit normals; 0 where the surface has shrunk to a point.
Vertices unitNormals(const Vertices& X, const Faces& F) {
    Vertices N = angleWeightedNormals<double>(X, F).vertices;
    N.rowwise().normalize();  // leaves zeros
    return N.array().isFinite().select(N, 0.0);
}

/// Edges between planes of different directions, at which the low-passed surface turns as far: of
/// roughness, only the first is true. A crease of the angle a is drawn in by sin(a / 2) times the
/// mean distance from it under the Gaussian, (2 / pi)^(1/2) sigma = .1495 cutoffs. Triangles longer
/// than half a cutoff are no roughness, and too coarse for the low-pass.
/// @param bend  n, of the low-pass (Separated), along its normals: a boundary is drawn across them.
std::vector<EdgeVertices> creasesOf(const Surface& surface, const Eigen::VectorXd& bend,
                                    double cutoff, double angle) {
    constexpr double kCoarse = 0.5;
    if (angle >= 180.0) return {};
    std::vector<EdgeVertices> edges = creaseEdges(surface.X, surface.F, angle);
    std::vector<bool> isCoarse(surface.vertex.size(), false);
    for (Index t = 0; t < surface.F.rows(); ++t)
        for (int k = 0; k < 3; ++k) {
            const int i = surface.F(t, k), j = surface.F(t, (k + 1) % 3);
            if ((surface.X.row(i) - surface.X.row(j)).norm() > kCoarse * cutoff)
                isCoarse[i] = isCoarse[j] = true;
        }
    const double sigma = std::sqrt(std::log(2.0) / 2.0) / kPi * cutoff;
    const double least = std::sin(0.5 * angle * kPi / 180.0) * std::sqrt(2.0 / kPi) * sigma *
                         (1.0 - std::sqrt(kBend));
    edges.erase(std::remove_if(edges.begin(), edges.end(),
                               [&](const EdgeVertices& edge) {
                                   const auto& [i, j] = edge;
                                   return !isCoarse[i] && !isCoarse[j] &&
                                          std::abs(bend[i] + bend[j]) < 2.0 * least;
                               }),
                edges.end());
    return edges;
}

/// Whether parts are thinner than a low-pass: around a cylinder with a circumference of .7 cutoffs
/// it leaves a quarter of the area, as of a sphere of one cutoff.
/// @param areas  n, of the vertices before it.
std::vector<bool> thinParts(const Eigen::VectorXd& areas, const Vertices& reference,
                            const Faces& F) {
    constexpr double kThin = 0.25;
    const Eigen::VectorXd left = lumpedMass(reference, F);
    std::vector<bool> thin(static_cast<std::size_t>(areas.size()));
    for (Index i = 0; i < areas.size(); ++i) thin[i] = left[i] < kThin * areas[i];
    return thin;
}

/// Heights, what they stand on, and which of them count.
struct Heights {
    MeshLaplacian mesh;
    std::vector<bool> selected{}, evaluated{};
    std::vector<bool> thin{};  ///< Left out on parts that the low-pass draws together.
    Eigen::VectorXd h{};
    Vertices reference{};
    int elsewhere = 0;  ///< Selected vertices that are not on the fitted shape.
    double leftOutSq = 0.0;
    double formRadius = 0.0;
    double errorEstimate = 0.0;
    bool accuracyReached = true;
};

double cutoffOf(const TextureOptions& options) {
    return options.waviness > 0.0 ? options.waviness : options.noise;
}

std::vector<bool> both(std::vector<bool> one, const std::vector<bool>& other) {
    for (std::size_t i = 0; i < one.size(); ++i) one[i] = one[i] && other[i];
    return one;
}

std::vector<bool> selectedOf(const Surface& surface, const TextureOptions& options) {
    if (!options.selected.empty()) return selectedOn(surface, options.selected);
    return std::vector<bool>(surface.vertex.size(), true);
}

/// Root mean square of the heights of what is selected, and near a boundary but no crease.
double leftOutSq(const Heights& heights, const std::vector<bool>& isInside,
                 const std::vector<bool>& isSmooth) {
    const Eigen::VectorXd& D = heights.mesh.laplacian.D;
    double sum = 0.0, area = 0.0;
    for (Index i = 0; i < D.size(); ++i) {
        if (!heights.selected[i] || isInside[i] || !isSmooth[i]) continue;
        sum += D[i] * std::pow(heights.h[i], 2);
        area += D[i];
    }
    return area > 0.0 ? std::sqrt(sum / area) : 0.0;
}

/// @throws InvalidOption  when no vertex is far from all ends.
void checkEvaluated(const Heights& heights, double cutoff) {
    if (std::count(heights.evaluated.begin(), heights.evaluated.end(), true) == 0)
        throw InvalidOption("waviness = " + textOf(cutoff) +
                            ": the whole surface is within this distance of its boundary or of "
                            "creases. Choose a smaller one, a larger crease_angle, or the plane, "
                            "sphere or cylinder that the surface is as form");
}

/// Drops what was appended to a surface of n vertices and m triangles.
void keepFirst(Index n, Index m, Heights& heights) {
    heights.h.conservativeResize(n);
    heights.reference.conservativeResize(n, 3);
    for (std::vector<bool>* flags : {&heights.selected, &heights.evaluated, &heights.thin})
        flags->resize(static_cast<std::size_t>(n));
    heights.mesh.surface.F.conservativeResize(m, 3);
    heights.mesh.surface.vertex.resize(static_cast<std::size_t>(n));
}

Heights heightsAboveShape(ShapeKind kind, Surface whole, const TextureOptions& options,
                          const Progress& progress) {
    constexpr double kPieces = 1.0 / 16.0;  // of the diagonal, without a cutoff
    const double cutoff = cutoffOf(options);
    const Eigen::RowVector3d box = whole.X.colwise().maxCoeff() - whole.X.colwise().minCoeff();
    const std::vector<bool> wanted = selectedOf(whole, options);
    FormPart form =
        formPart(kind, std::move(whole), wanted, cutoff > 0.0 ? cutoff : kPieces * box.norm());
    form.surface.X -= form.heights.d.asDiagonal() * form.heights.N;
    const Index n = form.surface.X.rows(), m = form.surface.F.rows();
    const Outline outline = outlineOf(form.surface, kHolePerCutoff * cutoff);
    Heights heights{meshLaplacian(bridged(std::move(form.surface), outline), options.laplacian)};
    const Eigen::VectorXd d = bridged(form.heights.d, outline);
    const Vertices N = bridged(form.heights.N, outline);
    const MeshLaplacian& mesh = heights.mesh;
    const std::vector<bool> isInside =
        farFrom(outlineOf(mesh.surface, kHolePerCutoff * cutoff).ends, mesh.surface,
                mesh.laplacian.W, cutoff);
    heights.selected = selectedOf(mesh.surface, options);
    heights.evaluated = both(heights.selected, isInside);
    std::fill(heights.evaluated.begin() + n, heights.evaluated.end(), false);
    checkEvaluated(heights, cutoff);
    const Separated parts = separated(mesh, d, options, progress);
    heights.h = parts.roughness.col(0);
    heights.thin.resize(isInside.size());
    heights.reference = mesh.surface.X + parts.waviness.col(0).asDiagonal() * N;
    heights.elsewhere = form.elsewhere;
    heights.leftOutSq = leftOutSq(heights, isInside, std::vector<bool>(isInside.size(), true));
    heights.formRadius = form.shape.radius;
    heights.errorEstimate = parts.errorEstimate;
    heights.accuracyReached = parts.accuracyReached;
    keepFirst(n, m, heights);
    return heights;
}

/// Whether the vertices that count keep their areas, to 1 %, without roughness: that of the slope s
/// takes s^2 / 2 of them, and makes waves longer by as much, which at the cutoff is 1.4 times as
/// much in height. On the whole, and where heights are: a few particles may be all there is.
bool isSmooth(const Heights& heights, const Vertices& smooth) {
    constexpr double kLeast = 0.99;
    const Eigen::VectorXd& before = heights.mesh.laplacian.D;
    const Eigen::VectorXd after = lumpedMass(smooth, heights.mesh.surface.F);
    Eigen::Array2d all = Eigen::Array2d::Zero(), left = Eigen::Array2d::Zero();
    for (Index i = 0; i < before.size(); ++i) {
        if (!heights.evaluated[i]) continue;
        const Eigen::Array2d weights(1.0, std::pow(heights.h[i], 2));
        all += before[i] * weights;
        left += after[i] * weights;
    }
    return (left >= kLeast * all).all();
}

Heights heightsAboveLowPass(Surface surface, const TextureOptions& options,
                            const Progress& progress) {
    constexpr int kPasses = 4;  // two, but for slopes above 1
    const double cutoff = options.waviness;
    const Index n = surface.X.rows(), m = surface.F.rows();
    const Outline outline = outlineOf(surface, kHolePerCutoff * cutoff);
    // A low-pass of coordinates would draw the rim of a hole away from it, to twice its width.
    surface = bridged(std::move(surface), outline);
    const Vertices X = surface.X;
    Heights heights{meshLaplacian(std::move(surface), options.laplacian)};
    MeshLaplacian& mesh = heights.mesh;
    const Eigen::VectorXd areas = mesh.laplacian.D;
    const std::vector<bool> inside = farFrom(outline.ends, mesh.surface, mesh.laplacian.W, cutoff);
    std::vector<bool> smooth, isFar;
    for (int pass = 0; pass < kPasses; ++pass) {
        const double begin = pass == 0 ? 0.0 : 0.7;
        const Separated parts = separated(mesh, X, options, progress.part(begin, 0.9));
        heights.reference = parts.waviness;
        heights.errorEstimate = parts.errorEstimate;
        heights.accuracyReached = parts.accuracyReached;
        const Vertices N = unitNormals(heights.reference, mesh.surface.F);
        const auto along = [&](const Eigen::MatrixXd& moved) -> Eigen::VectorXd {
            return moved.cwiseProduct(N).rowwise().sum();
        };
        if (pass == 0) {
            smooth =
                farFrom(creasesOf(mesh.surface, along(parts.bend), cutoff, options.creaseAngle),
                        mesh.surface, mesh.laplacian.W, cutoff);
            isFar = both(inside, smooth);
            heights.selected = selectedOf(mesh.surface, options);
            heights.evaluated = both(heights.selected, isFar);
            std::fill(heights.evaluated.begin() + n, heights.evaluated.end(), false);
            checkEvaluated(heights, cutoff);
        }
        heights.h = along(parts.roughness);
        if (options.form == FormKind::Size)
            heights.h -= formOf(heights.h, isFar, mesh, heights.reference, formSizeOf(options),
                                progress.part(0.9, 1.0));
        // Wavelengths are those on the smooth shape.
        const Vertices projection = X - heights.h.asDiagonal() * N;
        if (pass + 1 == kPasses || isSmooth(heights, projection)) break;
        surface = std::move(mesh.surface);
        surface.X = projection;
        mesh = meshLaplacian(std::move(surface), options.laplacian);
    }
    heights.thin = thinParts(areas, heights.reference, mesh.surface.F);
    heights.leftOutSq = leftOutSq(heights, inside, smooth);
    keepFirst(n, m, heights);
    return heights;
}

/// Refuses a surface of which one axis has another unit than the others, as heights often have.
void checkUnits(const Surface& surface) {
    const Points X = surface.X;
    const std::optional<int> axis = stretchedAxis(surface.F, X);
    if (!axis) return;
    const double slope = medianSlope(surface.F, X, *axis);
    // Slopes of roughness are .001 to 1: of the factors 1000 and 1e6, that which leaves such.
    const double factor = slope > 1000.0 ? 1e6 : 1000.0;
    const std::string name(1, "xyz"[*axis]);
    throw InvalidOption(name +
                        " has another unit than the other axes: half of the surface is "
                        "steeper than " +
                        textOf(slope) +
                        " along it, so that wavelengths have no "
                        "meaning. Bring the axes to one unit, e.g. divide " +
                        name + " by " + textOf(factor) +
                        (factor > 1000.0 ? " if it is in micrometres and the "
                                           "others in metres"
                                         : " if it is in micrometres and the others in "
                                           "millimetres"));
}

int countOf(const std::vector<bool>& flags) {
    return static_cast<int>(std::count(flags.begin(), flags.end(), true));
}

}  // namespace

SurfaceTexture surfaceTexture(const Vertices& V, const Faces& F, const TextureOptions& options,
                              const Progress& progress) {
    checkOptions(options);
    const ThreadTeam team(progress);
    checkMesh(V, F, options.laplacian);
    Surface whole = joinedSurface(V, F);
    checkUnits(whole);
    const std::optional<ShapeKind> kind = shapeKind(options.form);
    Heights heights = kind ? heightsAboveShape(*kind, std::move(whole), options, progress)
                           : heightsAboveLowPass(std::move(whole), options, progress);
    const MeshLaplacian& mesh = heights.mesh;
    std::vector<bool>& evaluated = heights.evaluated;
    const int count = countOf(evaluated);
    SurfaceTexture texture;
    texture.leftOut = countOf(heights.selected) - count + heights.elsewhere;
    texture.leftOutSq = heights.leftOutSq;
    for (std::size_t i = 0; i < evaluated.size(); ++i) {
        if (!evaluated[i] || !heights.thin[i]) continue;
        evaluated[i] = false;
        if (texture.tooThin++ == 0) texture.firstTooThin = static_cast<int>(mesh.surface.vertex[i]);
    }
    if (texture.tooThin == count)
        throw InvalidOption("waviness = " + textOf(cutoffOf(options)) +
                            ": all that could be measured is thinner than this, choose a smaller "
                            "one");
    static_cast<TextureParameters&>(texture) =
        textureParameters(heights.h, heights.reference, mesh.surface.F, evaluated);
    Vertices points(heights.h.size(), 3);
    for (Index i = 0; i < points.rows(); ++i) points.row(i) = V.row(mesh.surface.vertex[i]);
    texture.lengths = textureLengths(heights.h, points, heights.reference, evaluated);
    for (Index i = 0; i < heights.h.size(); ++i)
        if (!evaluated[i]) heights.h[i] = 0.0;
    texture.height = extended(heights.h, mesh.surface, V.rows());
    texture.evaluated = count - texture.tooThin;
    texture.formRadius = heights.formRadius;
    texture.errorEstimate = heights.errorEstimate;
    texture.accuracyReached = heights.accuracyReached;
    return texture;
}

}  // namespace spectral
