#include "core/analysis/surface_texture.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/analysis/evaluated_part.h"
#include "core/analysis/form_part.h"
#include "core/analysis/texture_filters.h"
#include "core/laplacian/vertex_weight.h"
#include "core/mesh/creases.h"
#include "core/mesh/measures.h"
#include "core/mesh/mesh_check.h"
#include "core/mesh/normals.h"
#include "core/noise/stretched_axis.h"
#include "core/support/errors.h"
#include "core/support/threads.h"
#include "core/support/types.h"

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

/// Unit normals; 0 where the surface has shrunk to a point.
Vertices unitNormals(const Vertices& X, const Faces& F) {
    Vertices N = angleWeightedNormals<double>(X, F).vertices;
    N.rowwise().normalize();  // leaves zeros
    return N.array().isFinite().select(N, 0.0);
}

/// Vertices of triangles that are longer than half a cutoff: no roughness, and too coarse for the
/// low-pass.
std::vector<bool> coarseVertices(const Vertices& X, const Faces& F, double cutoff) {
    constexpr double kCoarse = 0.5;
    std::vector<bool> isCoarse(static_cast<std::size_t>(X.rows()), false);
    for (Index t = 0; t < F.rows(); ++t)
        for (int k = 0; k < 3; ++k) {
            const int i = F(t, k), j = F(t, (k + 1) % 3);
            if ((X.row(i) - X.row(j)).squaredNorm() > std::pow(kCoarse * cutoff, 2))
                isCoarse[i] = isCoarse[j] = true;
        }
    return isCoarse;
}

/// Edges between planes of different directions, at which the low-passed surface turns as far: of
/// roughness, only the first is true. A crease of the angle a is drawn in by sin(a / 2) times the
/// mean distance from it under the Gaussian, (2 / pi)^(1/2) sigma = .1495 cutoffs. Coarse triangles
/// have all creases.
/// @param bend  n, of the low-pass (SeparatedSignal), along its normals: a boundary is drawn across
///              them.
std::vector<EdgeVertices> creasesOf(const Vertices& X, const Faces& F, const Eigen::VectorXd& bend,
                                    double cutoff, double angle) {
    if (angle >= 180.0) return {};
    std::vector<EdgeVertices> edges = creaseEdges(X, F, SidesByEdge(F), angle);
    const std::vector<bool> isCoarse = coarseVertices(X, F, cutoff);
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
    SeparatedSignal parts{Eigen::VectorXd::Zero(d.size()), d, {}};
    if (cutoff > 0.0)
        parts =
            TextureFilters(mesh, cutoff).separated(d, options.waviness, options.noise, progress);
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

/// The surface with most of its roughness taken off along its normals, so that no edge is
/// shortened; only lengths are measured on it. Vertices move half of the way to the mean of their
/// neighbours, as often as takes off what is shorter than a cutoff, more or less. A surface without
/// steep roughness stays as it is, for this also draws in what is curved.
Vertices smoothed(const Surface& surface, double cutoff) {
    constexpr double kSteps = 0.1;  // for a cutoff of an edge; they grow with its square
    constexpr double kMost = 30.0;
    constexpr double kFlat = 0.0025;  // additional area that changes no height by half a percent
    const Faces& F = surface.F;
    Eigen::VectorXd corners = Eigen::VectorXd::Zero(surface.X.rows());
    for (const int i : F.reshaped()) corners[i] += 1.0;
    const std::vector<bool> isCoarse = coarseVertices(surface.X, F, cutoff);
    const double steps =
        std::min(kMost, kSteps * std::pow(cutoff / meanEdgeLength(surface.X, F), 2));
    Vertices X = surface.X;
    for (int step = 0; step < steps; ++step) {
        Vertices sums = Vertices::Zero(X.rows(), 3);
        for (Index t = 0; t < F.rows(); ++t) {
            const auto corner = F.row(t);
            const Eigen::RowVector3d sum = X.row(corner[0]) + X.row(corner[1]) + X.row(corner[2]);
            for (const int i : corner) sums.row(i) += sum;
        }
        for (Index i = 0; i < X.rows(); ++i)  // sums have the vertex itself once for each corner
            if (!isCoarse[i]) X.row(i) = 0.25 * (X.row(i) + sums.row(i) / corners[i]);
    }
    const Vertices N = unitNormals(X, F);
    const Eigen::VectorXd d = (surface.X - X).cwiseProduct(N).rowwise().sum();
    const std::vector<bool> all(static_cast<std::size_t>(d.size()), true);
    if (slopesOf(d, X, F, all).Sdr < kFlat) return surface.X;
    return surface.X - d.asDiagonal() * N;
}

/// Whether the vertices that count have the areas, to 1 %, that they have without roughness: that
/// of the slope s takes s^2 / 2 of them, and makes waves longer by as much, which at the cutoff is
/// 1.4 times as much in height. On the whole, and where heights are: a few particles may be all
/// there is.
bool isSmooth(const Heights& heights, const Vertices& smooth) {
    constexpr double kMost = 0.01;
    const Eigen::VectorXd& before = heights.mesh.laplacian.D;
    const Eigen::VectorXd after = lumpedMass(smooth, heights.mesh.surface.F);
    Eigen::Array2d all = Eigen::Array2d::Zero(), left = Eigen::Array2d::Zero();
    for (Index i = 0; i < before.size(); ++i) {
        if (!heights.evaluated[i]) continue;
        const Eigen::Array2d weights(1.0, std::pow(heights.h[i], 2));
        all += before[i] * weights;
        left += after[i] * weights;
    }
    return ((left - all).abs() <= kMost * all).all();
}

Heights heightsAboveLowPass(Surface surface, const TextureOptions& options,
                            const Progress& progress) {
    constexpr int kPasses = 4;  // one or two, but for slopes above 1
    const double cutoff = options.waviness;
    const Index n = surface.X.rows(), m = surface.F.rows();
    const Outline outline = outlineOf(surface, kHolePerCutoff * cutoff);
    // A low-pass of coordinates would draw the rim of a hole away from it, to twice its width.
    surface = bridged(std::move(surface), outline);
    Vertices X = surface.X;
    surface.X = smoothed(surface, cutoff);
    Heights heights{meshLaplacian(std::move(surface), options.laplacian)};
    MeshLaplacian& mesh = heights.mesh;
    const std::vector<bool> inside = farFrom(outline.ends, mesh.surface, mesh.laplacian.W, cutoff);
    std::vector<bool> smooth, isFar;
    for (int pass = 0; pass < kPasses; ++pass) {
        TextureFilters filters(mesh, cutoff);
        const double begin = pass == 0 ? 0.0 : 0.7;
        const SeparatedSignal parts =
            filters.separated(X, cutoff, options.noise, progress.part(begin, 0.9));
        heights.reference = parts.waviness;
        heights.errorEstimate = parts.errorEstimate;
        heights.accuracyReached = parts.accuracyReached;
        const Vertices N = unitNormals(heights.reference, mesh.surface.F);
        const auto along = [&](const Eigen::MatrixXd& moved) -> Eigen::VectorXd {
            return moved.cwiseProduct(N).rowwise().sum();
        };
        if (pass == 0) {
            smooth = farFrom(
                creasesOf(X, mesh.surface.F, along(parts.bend), cutoff, options.creaseAngle),
                mesh.surface, mesh.laplacian.W, cutoff);
            isFar = both(inside, smooth);
            heights.selected = selectedOf(mesh.surface, options);
            heights.evaluated = both(heights.selected, isFar);
            std::fill(heights.evaluated.begin() + n, heights.evaluated.end(), false);
            checkEvaluated(heights, cutoff);
        }
        heights.h = along(parts.roughness);
        if (options.form == FormKind::Size)
            heights.h -= filters.formOf(heights.h, isFar, heights.reference, formSizeOf(options),
                                        progress.part(0.9, 1.0));
        // Wavelengths are those on the smooth shape.
        Vertices projection = X - heights.h.asDiagonal() * N;
        if (pass + 1 == kPasses || isSmooth(heights, projection)) break;
        surface = std::move(mesh.surface);
        surface.X = std::move(projection);
        mesh = meshLaplacian(std::move(surface), options.laplacian);
    }
    heights.thin = thinParts(lumpedMass(X, mesh.surface.F), heights.reference, mesh.surface.F);
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
