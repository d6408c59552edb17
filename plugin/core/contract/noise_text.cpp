#include "core/contract/noise_text.h"

#include <algorithm>
#include <cmath>

#include "core/contract/number_text.h"

namespace spectral {

namespace {

std::string voxelsText(const Eigen::RowVector3d& voxel) {
    return "voxel steps of " + numberText(voxel[0], 3) + " x " + numberText(voxel[1], 3) + " x " +
           numberText(voxel[2], 3);
}

std::string localText(const NoiseField& field) {
    const std::string lowest = numberText(field.lowest, 1), highest = numberText(field.highest, 1);
    const std::string upTo = lowest == highest ? "" : " to " + highest;
    const std::string where =
        field.isEverywhere()
            ? ""
            : std::to_string(std::max(1L, std::lround(100.0 * field.share))) + " % of ";
    return "noise of " + lowest + upTo + " edges on " + where + "the surface";
}

std::string noiseName(NoiseKind kind) {
    switch (kind) {
        case NoiseKind::Correlated: return "scanner noise";
        case NoiseKind::Impulses: return "impulse noise";
        case NoiseKind::ScanLines: return "noise on scan lines";
        case NoiseKind::Rounded: return "coordinates rounded to a grid";
        default: return "white noise";
    }
}

std::string namedText(const Diagnosis& diagnosis) {
    const NoiseEstimate& noise = diagnosis.noise;
    std::string text =
        noiseName(diagnosis.kind) + ": height " + inEdges(noise.height, noise.meanEdge);
    if (diagnosis.kind == NoiseKind::Correlated)
        text += ", size " + inEdges(noise.size * noise.meanEdge, noise.meanEdge);
    return text;
}

/// What to give where nothing was found: the noise that the detail measured in a shape would be, or
/// else ripples, which no measure tells from a shape.
std::string remedyText(const NoiseEstimate& noise, bool isShape) {
    constexpr double kRippleHeight = 0.1, kRippleSize = 2.0;  // edges
    const double edge = noise.meanEdge;
    const bool isDetail = isShape && noise.height >= kMinHeight * edge;
    const double height = isDetail ? noise.height / edge : kRippleHeight;
    const double size = isDetail ? noise.size : kRippleSize;
    std::string values = "noise height " + numberText(height * edge, 2);
    std::string edges = numberText(height, 2);
    if (size > 1.0) {
        values += " and noise size " + numberText(size * edge, 2);
        edges += " and " + numberText(size, 2);
    }
    values += " (" + edges + " edges)";
    return isDetail ? "If its finest detail is noise, try " + values +
                          ", or Spectral Filter (Fractional)"
                    : "For ripples with crests some four edges apart, try " + values +
                          "; for wider ones, Spectral Filter (Fractional)";
}

/// Why there is nothing to remove, and what to give instead, in numbers of this mesh.
std::string nothingText(const Diagnosis& diagnosis) {
    const std::string height = numberText(0.1 * diagnosis.noise.meanEdge, 2);
    switch (diagnosis.kind) {
        case NoiseKind::Stretched:
            return std::string(1, "xyz"[diagnosis.stretchedAxis.value_or(2)]) +
                   " has another unit than the other axes, as in a terrain of degrees and metres: "
                   "the triangles stand upright, and noise cannot be told from shape. Bring the "
                   "axes to one unit first, e.g. project degrees to metres (UTM)";
        case NoiseKind::Tessellation:
            return "needle triangles as in a CAD model, not a scan: the mesh was not searched for "
                   "noise. If it has noise, give the noise height, such as " +
                   height + " (0.1 edges), or remesh first";
        case NoiseKind::TooFew:
            return "too few vertices to tell noise from shape. If the mesh has noise, give the "
                   "noise height, such as " +
                   height + " (0.1 edges)";
        default:
            return std::string(
                       "found no noise clearly distinct from the shape: neither everywhere "
                       "nor in some regions, and no ") +
                   (diagnosis.spikes == 0 ? "spikes, " : "") +
                   "voxel steps or rounded coordinates. " +
                   remedyText(diagnosis.noise, diagnosis.kind == NoiseKind::Shape);
    }
}

}  // namespace

std::string kindText(NoiseKind kind) {
    switch (kind) {
        case NoiseKind::None: return "none";
        case NoiseKind::Shape: return "shape";
        case NoiseKind::Tessellation: return "tessellation";
        case NoiseKind::Stretched: return "stretched";
        case NoiseKind::TooFew: return "too_few";
        case NoiseKind::Voxels: return "voxels";
        case NoiseKind::Rounded: return "rounded";
        case NoiseKind::White: return "white";
        case NoiseKind::Impulses: return "impulses";
        case NoiseKind::Local: return "local";
        case NoiseKind::ScanLines: return "scan_lines";
        case NoiseKind::Correlated: break;
    }
    return "correlated";
}

std::string inEdges(double length, double edge) {
    return numberText(length / edge, 2) + " edges (" + numberText(length, 3) + ")";
}

std::string noiseText(const Diagnosis& diagnosis) {
    if (!diagnosis.isNoise()) return nothingText(diagnosis);
    if (diagnosis.kind == NoiseKind::Voxels) return voxelsText(diagnosis.voxel);
    if (diagnosis.kind == NoiseKind::Local) return localText(diagnosis.field);
    return namedText(diagnosis);
}

std::string spikesText(const Diagnosis& diagnosis) {
    if (diagnosis.spikes == 0) return "";
    if (diagnosis.spikes == 1) return "a spike";
    return "spikes at " + std::to_string(diagnosis.spikes) + " vertices";
}

std::string diagnosisText(const Diagnosis& diagnosis) {
    const std::string spikes = spikesText(diagnosis);
    return (spikes.empty() ? "" : spikes + "; ") + noiseText(diagnosis);
}

}  // namespace spectral
