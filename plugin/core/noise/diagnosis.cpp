#include "core/noise/diagnosis.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/graph/robust_statistics.h"
#include "core/mesh/measures.h"
#include "core/noise/scan_lines.h"
#include "core/noise/spikes.h"
#include "core/noise/stretched_axis.h"
#include "core/noise/voxel_lattice.h"
#include "core/support/threads.h"

namespace spectral {

namespace {

const char* const kStage = "measuring the noise";

struct FoundSpikes {
    Spikes spikes;
    bool areTail = false;  ///< Not isolated spikes but the heavy tail of the noise itself.
};

FoundSpikes sparseSpikes(const FaceGraph& graph, const Points& X, const std::vector<bool>& mayMove,
                         double meanEdge) {
    constexpr double kDetectionLimit = 4.0, kRemovalLimit = 3.0;  // deviations
    constexpr Index kMinCount = 50;
    constexpr double kMinShareOfTail = 0.004;
    constexpr double kMinShareOfSpikes = 0.01;  // fewer are told by their own heights
    // Of the residuals (localTail): 4 on pierrot_i3, 2.5 for noise of any distribution over the
    // surface.
    constexpr double kMinTailOfSpikes = 3.0;
    Spikes spikes = findSpikes(graph, X, mayMove, kDetectionLimit, meanEdge);
    if (spikes.share() >= kMinShareOfSpikes &&
        localTail(graph.vertices, localResiduals(graph, X, mayMove), mayMove) > kMinTailOfSpikes)
        return {findSpikes(graph, X, mayMove, kRemovalLimit, meanEdge)};
    const bool areTail = spikes.count >= kMinCount && spikes.share() >= kMinShareOfTail;
    return {certainSpikes(graph, X, std::move(spikes), meanEdge), areTail};
}

/// Fraction of the progress for the mesh as one, before its places.
constexpr double kWholeMesh = 0.7;

/// Share of the height that is noise. It decreases above a correlation of residuals that may come
/// from a coarse shape with a little noise.
double noiseShare(double correlation) {
    constexpr double kSlope = 14.0;
    // Of noise of .1 edges on a coarse statue, .3 leaves 80 % of the angle; 1 takes some of it.
    constexpr double kLeast = 0.4;
    return std::clamp(1.0 - kSlope * (correlation - kMaxPureNoise), kLeast, 1.0);
}

// Surfaces of volumes have steps of an edge or so, coordinates rounded to a grid .05 to .11. Edges:
constexpr double kMinVoxel = 0.3, kMinRounding = 0.04;

/// Notes voxels if the vertices are those of the surface of a binary volume.
bool noteLattice(const SortedPoints& X, bool areAllOn, Diagnosis& diagnosis) {
    constexpr double kLength = 1.5;  // voxels
    const auto lattice = voxelLattice(X, areAllOn);
    if (!lattice) return false;
    diagnosis.kind = NoiseKind::Voxels;
    diagnosis.voxel = lattice->voxel;
    diagnosis.stepLength = kLength * lattice->edges;
    return true;
}

/// Notes voxels if the vertices on a grid are those of the surface of a volume's voxel faces.
void findVoxelFaces(const FaceGraph& graph, const CoordinateGrid& grid,
                    const std::vector<bool>& isMeasured, Diagnosis& diagnosis) {
    // Of weighted residuals, mean edges: designed shapes are flat.
    constexpr double kMinDeviationOfFaces = 0.01;
    constexpr double kLength = 2.0;  // voxels
    const double edge = diagnosis.noise.meanEdge;
    if (grid.step.minCoeff() < kMinVoxel * edge) return;
    if (!(weightedResiduals(graph, diagnosis.X, isMeasured).deviation >
          kMinDeviationOfFaces * edge))
        return;
    diagnosis.kind = NoiseKind::Voxels;
    diagnosis.voxel = grid.step;
    diagnosis.stepLength = kLength;
}

/// Notes voxels of a volume that may be turned, and where only most of the vertices may be of it.
/// @return  the grid of all coordinates as they are, if there is one.
std::optional<CoordinateGrid> findVoxels(const FaceGraph& graph,
                                         const std::vector<bool>& isMeasured,
                                         Diagnosis& diagnosis) {
    std::vector<Eigen::Matrix3d> candidates{Eigen::Matrix3d::Identity()};
    for (std::size_t k = 0; k < candidates.size(); ++k) {
        const SortedPoints X(diagnosis.X * candidates[k].transpose());
        diagnosis.voxelAxes = candidates[k];
        const auto grid = coordinateGrid(X);
        if (noteLattice(X, true, diagnosis)) return grid;
        if (grid)
            findVoxelFaces(graph, *grid, isMeasured, diagnosis);
        else
            noteLattice(X, false, diagnosis);
        if (diagnosis.kind != NoiseKind::None || (k == 0 && grid)) return grid;
        if (k > 0) continue;
        const auto turned = latticeAxes(graph, diagnosis.X);
        candidates.insert(candidates.end(), turned.begin(), turned.end());
    }
    return std::nullopt;
}

/// Notes rounding if the coordinates were rounded to the grid.
void findRounding(const CoordinateGrid& grid, Diagnosis& diagnosis) {
    const double edge = diagnosis.noise.meanEdge;
    if (!(grid.step.minCoeff() > kMinRounding * edge && grid.step.maxCoeff() < kMinVoxel * edge))
        return;
    const double height = std::sqrt(grid.step.squaredNorm() / 3.0 / 12.0);  // of uniform noise
    diagnosis.kind = NoiseKind::Rounded;
    diagnosis.noise.height = height;
    diagnosis.field = NoiseField::ofHeight(height, edge, diagnosis.X.rows());
}

/// Fewer vertices are too few to tell noise from corners: those of a tetrahedron alternate, too.
constexpr Index kMinMeasured = 100;

/// The measured vertices of components that have enough of them.
std::vector<bool> inLargeComponents(const FaceGraph& graph, std::vector<bool> isMeasured) {
    const Index n = static_cast<Index>(isMeasured.size());
    const Components components = connectedComponents(graph.F, n);
    std::vector<Index> measured(static_cast<std::size_t>(components.count));
    for (Index i = 0; i < n; ++i) measured[components.label[i]] += isMeasured[i];
    for (Index i = 0; i < n; ++i)
        isMeasured[i] = isMeasured[i] && measured[components.label[i]] >= kMinMeasured;
    return isMeasured;
}

/// Adds the components without the noise of the whole: quiet ones, in length units and in their own
/// edges, and those of too few vertices to tell, unless most are.
void addCleanComponents(const FaceGraph& graph, std::vector<bool> isMeasured, Diagnosis& whole) {
    constexpr double kQuiet = 0.25;  // height over that of the whole
    const Index n = whole.X.rows();
    const Components components = connectedComponents(graph.F, n);
    if (components.count < 2) return;
    struct Component {
        std::vector<double> moduli;  // of the residuals of its measured vertices
        double length = 0.0;         // of its edges
        Index edges = 0;
        bool isClean = false;
    };
    std::vector<Component> parts(static_cast<std::size_t>(components.count));
    const VertexGraph& vertices = graph.vertices;
    std::vector<Index> measured(parts.size());
    for (Index i = 0; i < n; ++i) measured[components.label[i]] += isMeasured[i];
    const Eigen::VectorXd residual =
        scaledSecondResiduals(graph, whole.X, smoothVertexNormals(graph, whole.X), isMeasured);
    for (Index i = 0; i < n; ++i) {
        Component& part = parts[components.label[i]];
        if (isMeasured[i]) part.moduli.push_back(std::abs(residual[i]));
        for (Index k = vertices.first[i]; k < vertices.first[i + 1]; ++k)
            part.length += (whole.X.row(i) - whole.X.row(vertices.at[k])).norm();
        part.edges += vertices.degree(i);
    }
    Index few = 0, all = 0;  // vertices
    for (const Index count : measured) {
        few += count < kMinMeasured ? count : 0;
        all += count;
    }
    for (std::size_t k = 0; k < parts.size(); ++k) {
        Component& part = parts[k];
        const double edge = part.length / static_cast<double>(std::max<Index>(part.edges, 1));
        const double limit =
            kQuiet * whole.noise.height * std::min(1.0, edge / whole.noise.meanEdge);
        part.isClean = measured[k] < kMinMeasured ? 2 * few < all
                                                  : medianDeviation(std::move(part.moduli)) < limit;
    }
    whole.isClean.resize(static_cast<std::size_t>(n), false);
    for (Index i = 0; i < n; ++i)
        if (parts[components.label[i]].isClean) whole.isClean[i] = true;
}

/// Adds the vertices of flat parts, such as lakes of a terrain: many connected faces in one plane.
void addFlatParts(const FaceGraph& graph, const Points& X, std::vector<bool>& isClean) {
    constexpr double kSame = 1.0 - 1e-10;  // cosine: of a hundred-thousandth of a radian
    constexpr std::size_t kMinFaces = 50;
    Points N = areaNormals(X, graph.F);
    normalizeRows(N);
    std::vector<bool> isReached(static_cast<std::size_t>(graph.faceCount()), false);
    std::vector<int> part;
    for (int start = 0; start < graph.faceCount(); ++start) {
        part.clear();
        const auto reach = [&](int f, int from) {
            if (f < 0 || isReached[f] || !(N.row(f).dot(N.row(from)) > kSame)) return;
            isReached[f] = true;
            part.push_back(f);
        };
        reach(start, start);
        for (std::size_t k = 0; k < part.size(); ++k)
            for (int c = 0; c < 3; ++c) reach(graph.neighbours(part[k], c), part[k]);
        if (part.size() < kMinFaces) continue;
        isClean.resize(static_cast<std::size_t>(X.rows()), false);
        for (const int f : part)
            for (int c = 0; c < 3; ++c) isClean[graph.F(f, c)] = true;
    }
}

/// The noise of the mesh as one.
Diagnosis diagnoseWhole(const FaceGraph& graph, const Points& X,
                        const std::vector<bool>& isMeasured, bool isKnown,
                        const Progress& progress) {
    constexpr double kMaxCorrelationOfNoise = 0.2;  // above it, the residuals are those of a shape
    constexpr double kHighNoise = 0.09;  // mean edges: no shape alternates as high, if at all
    Diagnosis diagnosis;
    diagnosis.X = X;
    const double edge = diagnosis.noise.meanEdge = meanEdgeLength(X, graph.F);
    const Index measured = std::count(isMeasured.begin(), isMeasured.end(), true);
    diagnosis.stretchedAxis = stretchedAxis(graph.F, X);
    const bool areNeedles = quantile(triangleQuality(graph.F, X), 0.5) < kNeedleQuality;
    std::optional<CoordinateGrid> grid;
    if (!isKnown) {
        grid = findVoxels(graph, isMeasured, diagnosis);
        if (diagnosis.kind != NoiseKind::None) return diagnosis;
        if (diagnosis.stretchedAxis) {
            diagnosis.kind = NoiseKind::Stretched;
            return diagnosis;
        }
        if (areNeedles) {
            diagnosis.kind = NoiseKind::Tessellation;
            if (const auto lines = scanLineNoise(graph, X, isMeasured)) {
                diagnosis.kind = NoiseKind::ScanLines;
                diagnosis.noise.height = lines->height;
                diagnosis.field = NoiseField::ofHeight(lines->height, lines->edge, X.rows());
            }
            return diagnosis;
        }
    }
    if (measured < kMinMeasured) {
        diagnosis.kind = NoiseKind::TooFew;
        return diagnosis;
    }
    if (grid) findRounding(*grid, diagnosis);
    if (diagnosis.kind != NoiseKind::None) return diagnosis;
    progress.report(0.2, kStage);
    const FoundSpikes found = sparseSpikes(graph, X, isMeasured, edge);
    diagnosis.spikes = found.spikes.count;
    if (diagnosis.spikes > 0) diagnosis.X -= found.spikes.height.asDiagonal() * found.spikes.N;
    progress.report(0.6, kStage);
    const Points N = smoothVertexNormals(graph, diagnosis.X);
    const double correlation = residualCorrelation(graph, diagnosis.X, N, isMeasured);
    const SecondResiduals second = secondResiduals(graph, diagnosis.X, N, isMeasured);
    const bool isOther =
        !second.isNoise(correlation, edge) &&
        isOtherNoise(graph, diagnosis.X, N, isMeasured, correlation, second.correlation);
    const bool isWhite = isOther || second.isNoise(correlation, edge);
    NoiseEstimate& noise = diagnosis.noise;
    diagnosis.kind = NoiseKind::Shape;
    const bool isRising = !isWhite && correlation >= kMaxCorrelationOfNoise;
    if (isKnown || !isRising)
        noise =
            estimateNoise(graph, diagnosis.X, N, isMeasured, correlation, second, isOther, edge);
    noise.correlation = correlation;
    noise.isUnderShape = noise.isUnderShape && !areNeedles;
    if (isRising || noise.isShape) return diagnosis;
    const double share = isOther ? 1.0 : noiseShare(correlation);
    if (noise.size > 1.0) {
        // Mean edges that are certainly noise: .04 to .05 on a sheet with many holes and white
        // noise of .05; .076 on a scan by structured light.
        constexpr double kMinCorrelated = 0.06;
        if (share * noise.height >= kMinCorrelated * edge) diagnosis.kind = NoiseKind::Correlated;
        return diagnosis;
    }
    if (!isWhite && !noise.isUnderShape && noise.height < kHighNoise * edge) return diagnosis;
    if (!noise.isUnderShape) noise.height *= share;
    addFlatParts(graph, X, diagnosis.isClean);
    diagnosis.kind = noise.height < kMinHeight * edge ? NoiseKind::None
                     : found.areTail                  ? NoiseKind::Impulses
                                                      : NoiseKind::White;
    return diagnosis;
}

/// The noise by place, where that explains more than the diagnosis of the whole mesh.
NoiseField localNoise(const FaceGraph& graph, const std::vector<bool>& isMeasuredInWhole,
                      const Diagnosis& whole) {
    const bool isWhite = whole.kind == NoiseKind::White || whole.kind == NoiseKind::Impulses;
    const bool isCorrelated = whole.kind == NoiseKind::Correlated;
    if (!isWhite && !isCorrelated && whole.kind != NoiseKind::None &&
        whole.kind != NoiseKind::Shape)
        return {};
    if (whole.noise.isShape) return {};
    const std::vector<bool> isMeasured = inLargeComponents(graph, isMeasuredInWhole);
    const LocalResiduals residuals = localResiduals(graph, whole.X, isMeasured);
    if ((isWhite || isCorrelated) && areAlike(graph, whole.X, residuals, isMeasured)) return {};
    return measureNoiseField(graph, whole.X, isMeasured, residuals);
}

}  // namespace

bool Diagnosis::isNoise() const {
    switch (kind) {
        case NoiseKind::None:
        case NoiseKind::Shape:
        case NoiseKind::Tessellation:
        case NoiseKind::Stretched:
        case NoiseKind::TooFew: return false;
        default: return true;
    }
}

double Diagnosis::rmsHeight() const {
    if (!isNoise()) return 0.0;
    if (kind != NoiseKind::Local) return noise.height;
    return field.height.norm() / std::sqrt(static_cast<double>(field.height.size()));
}

Diagnosis diagnose(const FaceGraph& graph, const Points& X, const std::vector<bool>& isMeasured,
                   bool isKnown, const Progress& progress) {
    Diagnosis diagnosis =
        diagnoseWhole(graph, X, isMeasured, isKnown, progress.part(0.0, kWholeMesh));
    const bool isOnAll = diagnosis.kind == NoiseKind::White ||
                         diagnosis.kind == NoiseKind::Impulses ||
                         diagnosis.kind == NoiseKind::Correlated;
    if (isOnAll) addCleanComponents(graph, isMeasured, diagnosis);
    if (isKnown) return diagnosis;
    NoiseField field = localNoise(graph, isMeasured, diagnosis);
    if (field.isAny()) {
        for (std::size_t i = 0; i < diagnosis.isClean.size(); ++i)
            if (diagnosis.isClean[i]) field.height[static_cast<Index>(i)] = 0.0;
        addFlatParts(graph, X, diagnosis.isClean);
        diagnosis.field = std::move(field);
        diagnosis.kind = NoiseKind::Local;
        diagnosis.noise.size = 1.0;
        std::vector<double> heights;
        for (const double height : diagnosis.field.height)
            if (height > 0.0) heights.push_back(height);
        diagnosis.noise.height = quantile(std::move(heights), 0.5);
    }
    return diagnosis;
}

Diagnosis diagnose(const Surface& surface, const Progress& progress) {
    const Index n = surface.X.rows();
    const FaceGraph graph = faceGraph(distinctFaces(surface.F, n), n);
    std::vector<bool> isMeasured(graph.onRim);
    isMeasured.flip();
    return diagnose(graph, surface.X, isMeasured, false, progress);
}

}  // namespace spectral
