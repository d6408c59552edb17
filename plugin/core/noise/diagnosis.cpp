#include "core/noise/diagnosis.h"

#include <algorithm>
#include <cmath>

#include "core/mesh/measures.h"
#include "core/noise/robust_statistics.h"
#include "core/noise/spikes.h"
#include "core/noise/voxel_lattice.h"
#include "core/support/threads.h"

namespace spectral {

namespace {

const char* const kStage = "measuring the noise";

/// Median of 4 sqrt(3) area / (sum of squared sides) over the faces: 1 for equilateral triangles.
double medianQuality(const FaceGraph& graph, const Points& X) {
    std::vector<double> quality(static_cast<std::size_t>(graph.faceCount()));
    const Points N = areaNormals(X, graph.F);
    parallelRows(graph.faceCount(), [&](Index begin, Index end) {
        for (Index f = begin; f < end; ++f) {
            double squares = 0.0;
            for (int c = 0; c < 3; ++c)
                squares += (X.row(graph.F(f, c)) - X.row(graph.F(f, (c + 1) % 3))).squaredNorm();
            quality[f] = squares > 0.0 ? 2.0 * std::sqrt(3.0) * N.row(f).norm() / squares : 0.0;
        }
    });
    return quantile(std::move(quality), 0.5);
}

struct FoundSpikes {
    Spikes spikes;
    bool areTail = false;  ///< None of them is single: the noise itself has many large values.
};

FoundSpikes sparseSpikes(const FaceGraph& graph, const Points& X, const std::vector<bool>& mayMove,
                         double meanEdge) {
    constexpr double kJudgedFrom = 4.0, kRemovedFrom = 3.0;  // deviations
    constexpr Index kFewest = 50;
    constexpr double kLeastShare = 0.01, kLeastShareOfTail = 0.004;
    constexpr double kMostClustering = 2.0;
    constexpr Index kMostMore = 3;  // times as many from fewer deviations on
    Spikes spikes = findSpikes(graph, X, mayMove, kJudgedFrom, meanEdge);
    const bool areUnrelated = spikes.count >= kFewest && spikes.clustering < kMostClustering;
    bool areTail = areUnrelated && spikes.share() >= kLeastShareOfTail;
    if (areUnrelated && spikes.share() >= kLeastShare) {
        Spikes all = findSpikes(graph, X, mayMove, kRemovedFrom, meanEdge);
        areTail = all.count > kMostMore * spikes.count;
        if (!areTail) return {std::move(all)};
    }
    return {certainSpikes(graph, X, std::move(spikes), meanEdge), areTail};
}

/// Share of the height that is noise. From a correlation of residuals on that a scanner's noise may
/// have, but coarse shapes with a little noise have, too, more and more of it is the shape's.
double noiseShare(double correlation) {
    constexpr double kNoneOfShape = 0.1, kFall = 14.0, kLeast = 0.3;
    return std::clamp(1.0 - kFall * (correlation - kNoneOfShape), kLeast, 1.0);
}

}  // namespace

Diagnosis diagnose(const FaceGraph& graph, const Points& X, const std::vector<bool>& isMeasured,
                   bool isKnown, const Progress& progress) {
    constexpr Index kFewest = 100, kFewestOfCorrelated = 1000;  // measured vertices
    constexpr double kLeastQuality = 0.6;
    constexpr double kLeastHeight = 0.02, kLeastOfCorrelated = 0.045;  // mean edges
    constexpr double kMostCorrelation = 0.2;                           // of noise
    Diagnosis diagnosis;
    diagnosis.X = X;
    const double edge = diagnosis.noise.meanEdge = meanEdgeLength(X, graph.F);
    if (!isKnown) {
        if (const auto voxel = voxelLattice(X)) {
            diagnosis.kind = NoiseKind::Voxels;
            diagnosis.voxel = *voxel;
            return diagnosis;
        }
        if (medianQuality(graph, X) < kLeastQuality) {
            diagnosis.kind = NoiseKind::Tessellation;
            return diagnosis;
        }
    }
    const Index measured = std::count(isMeasured.begin(), isMeasured.end(), true);
    if (measured < kFewest) {
        diagnosis.kind = NoiseKind::TooFew;
        return diagnosis;
    }
    progress.report(0.2, kStage);
    const FoundSpikes found = sparseSpikes(graph, X, isMeasured, edge);
    diagnosis.spikes = found.spikes.count;
    if (diagnosis.spikes > 0) diagnosis.X -= found.spikes.height.asDiagonal() * found.spikes.N;
    progress.report(0.6, kStage);
    const double correlation = residualCorrelation(graph, diagnosis.X, isMeasured);
    diagnosis.kind = NoiseKind::Shape;
    if (isKnown || correlation < kMostCorrelation)
        diagnosis.noise = estimateNoise(graph, diagnosis.X, isMeasured, correlation, edge);
    diagnosis.noise.correlation = correlation;
    if (correlation >= kMostCorrelation) return diagnosis;

    NoiseEstimate& noise = diagnosis.noise;
    const double share = noiseShare(correlation);
    if (noise.size > 1.0) {
        if (measured >= kFewestOfCorrelated && share * noise.height >= kLeastOfCorrelated * edge)
            diagnosis.kind = NoiseKind::Correlated;
        return diagnosis;
    }
    noise.height *= share;
    if (noise.height >= kLeastHeight * edge)
        diagnosis.kind = found.areTail ? NoiseKind::Impulses : NoiseKind::White;
    else if (share == 1.0)
        diagnosis.kind = NoiseKind::None;
    return diagnosis;
}

}  // namespace spectral
