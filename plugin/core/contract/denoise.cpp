#include "core/denoise/denoise.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "core/contract/common_fields.h"
#include "core/contract/filters.h"
#include "core/contract/noise_text.h"
#include "core/contract/report.h"
#include "core/contract/surface_report.h"

namespace spectral {

namespace {

struct DenoiseCall : DenoiseOptions {
    bool onlySelected = false;
    Weight weightBy = Weight::None;
    bool storeNoiseHeight = false;
};

Fields<DenoiseCall> denoiseFields() {
    using Call = DenoiseCall;
    return {
        field<Call>(&Call::strength, "strength", "Denoising strength",
                    "1 removes the noise as measured. More also removes fine details; less leaves "
                    "some noise; 0 only looks for it, and changes nothing.")
            .in("factor"),
        field<Call>(&Call::noiseHeight, "noise_height", "Noise height",
                    "Standard deviation of the noise along the normals, such as 0.2e. Set it if "
                    "details were mistaken for noise, or noise for details. The default: as "
                    "measured, which the report states.")
            .in("length")
            .length("auto", nullptr, "0: as measured")
            .upToShare(0.2),
        field<Call>(
            &Call::noiseSize, "noise_size", "Noise size",
            "Distance over which the noise is correlated: half the width of its bumps, such "
            "as 2e. Noise of up to one mean edge is independent at each vertex. The default: "
            "as measured.")
            .in("length")
            .length("auto", nullptr, "0: as measured"),
        selectedField<Call>(&Call::onlySelected, "four edges"),
        field<Call>(&Call::keepCreases, "keep_creases", "Keep creases",
                    "Do not smooth across creases. Off: creases are rounded; for shapes without "
                    "any.")
            .advanced(),
        maxDisplacementField<Call>(&Call::maxDisplacement),
        weightField<Call>(
            &Call::weightBy,
            "factor on the |noise_height| at each vertex, from 0 (no noise) to 1, for "
            "noise that varies over the surface. *none*: as measured, or the "
            "same everywhere."),
        boundaryField<Call>(&Call::boundary,
                            "*free*: it moves along its normals, no further than the noise "
                            "explains. *fixed*: it stays exactly in place."),
        field<Call>(&Call::storeNoiseHeight, "store_noise_height", "Store noise height",
                    "Store the height of the noise found at each vertex, 0 where there is none, "
                    "as the vertex attribute noise_height.")
            .advanced(),
    };
}

/// Whether the estimate of noise was made.
bool isSearched(NoiseKind kind) {
    return kind != NoiseKind::Tessellation && kind != NoiseKind::Stretched &&
           kind != NoiseKind::TooFew && kind != NoiseKind::Voxels;
}

/// Share of the surface with noise.
double noiseShare(const Diagnosis& diagnosis) {
    if (!diagnosis.isNoise()) return 0.0;
    return diagnosis.kind == NoiseKind::Local ? diagnosis.field.share : 1.0;
}

Entries<DenoiseResult> denoiseEntries() {
    using R = DenoiseResult;
    return joined<R>(
        {{
             {"noise_kind",
              "white, correlated (of a scanner), impulses, scan_lines, rounded (coordinates), "
              "local (in some regions) or voxels; without noise: none, shape (it may be noise), "
              "tessellation (of CAD), stretched (axis), or too_few (vertices)",
              [](const R& r) -> Value { return kindText(r.diagnosis.kind); }},
             {"noise_share", "share of the surface with noise, 0 to 1",
              [](const R& r) -> Value { return noiseShare(r.diagnosis); }},
             {"noise_height", "of the noise that was filtered or found, length; 0: none",
              &R::noiseHeight},
             {"noise_size",
              "of the noise that was filtered, length; 0: independent at every vertex, or none",
              &R::noiseSize},
             {"estimated_noise_height",
              "measured standard deviation of the noise along the normals, length",
              [](const R& r) -> Value { return r.diagnosis.noise.height; }},
             {"estimated_noise_size",
              "measured distance over which the noise is correlated, length",
              [](const R& r) -> Value {
                  return r.diagnosis.noise.size * r.diagnosis.noise.meanEdge;
              }},
             {"noise_correlation",
              "measured correlation between neighbouring vertices; above 0.2 it is shape",
              [](const R& r) -> Value { return r.diagnosis.noise.correlation; }},
             {"noise_searched",
              "whether the mesh was searched for noise: not if it has needle triangles, voxels or "
              "too few vertices",
              [](const R& r) -> Value { return isSearched(r.diagnosis.kind); }},
             {"spikes", "number of vertices off the surface that were put back",
              [](const R& r) -> Value { return static_cast<int>(r.diagnosis.spikes); }},
             {"voxel_size", "of the volume that was segmented, along each axis, length; 0: none",
              [](const R& r) -> Value { return Eigen::VectorXd(r.diagnosis.voxel); }},
             {"mean_edge", "mean edge, length",
              [](const R& r) -> Value { return r.diagnosis.noise.meanEdge; }},
             {"rounds",
              "number of weak filters that were applied to the normals; 0: nothing changed",
              &R::rounds},
         },
         movementEntries<R>()});
}

/// What was chosen instead of the whole displacement.
std::string strengthText(double strength) {
    return strength == 1.0 ? "" : ", times " + textOf(strength);
}

std::string removedText(const DenoiseOptions& options, const DenoiseResult& result) {
    const Diagnosis& diagnosis = result.diagnosis;
    const std::string removed = "removed" + strengthText(options.strength);
    if (options.noiseHeight > 0.0) {
        const double edge = diagnosis.noise.meanEdge;
        std::string text = options.weight.size() > 0
                               ? noiseText(diagnosis)
                               : "noise: height " + inEdges(options.noiseHeight, edge);
        if (result.noiseSize > 0.0) text += ", size " + inEdges(result.noiseSize, edge);
        return text + ", as given: " + removed;
    }
    if (diagnosis.kind == NoiseKind::Voxels)
        return noiseText(diagnosis) + ": smoothed within half a voxel";
    const bool isInPlaces = diagnosis.kind == NoiseKind::Local && !diagnosis.field.isEverywhere();
    return noiseText(diagnosis) + ": " + removed +
           (isInPlaces ? "; no noise found in the rest" : "");
}

/// Why nothing was removed.
std::string nothingText(const Diagnosis& diagnosis, bool isCrumpled) {
    if (!isCrumpled) return noiseText(diagnosis);
    const char* const cause = diagnosis.stretchedAxis
                                  ? "where one axis has another unit than the others, such as "
                                    "degrees and metres. Bring them to one unit first"
                                  : "at needle triangles, e.g. of CAD models. Remesh first";
    return std::string(
               "the noise was not removed: that would have folded the surface over, as "
               "happens ") +
           cause + ", or give a smaller noise height or size";
}

/// What was found and done, in one line; at strength 0 what was found.
std::string summaryOf(const DenoiseOptions& options, const DenoiseResult& result) {
    std::ostringstream text;
    if (const std::string note = selectionText(options.selected); !note.empty())
        text << note << "; ";
    if (options.strength == 0.0) return text.str() + diagnosisText(result.diagnosis);
    if (const std::string spikes = spikesText(result.diagnosis); !spikes.empty())
        text << spikes << ": removed; ";
    if (result.rounds > 0)
        text << removedText(options, result) << limitText(result.limitedShare);
    else
        text << nothingText(result.diagnosis, result.isCrumpled)
             << (result.maxDisplacement == 0.0 ? "; nothing changed" : "");
    return text.str();
}

std::string reportText(const std::string& summary, const DenoiseResult& result, double diagonal) {
    std::ostringstream text;
    if (result.maxDisplacement > 0.0)
        text << movementText("Denoised", result.meanDisplacement, result.maxDisplacement, diagonal)
             << "\n  ";
    text << "Spectral Denoise: " << summary;
    if (result.maxDisplacement > 0.0)
        text << "; root mean square " << std::setprecision(3) << result.rmsDisplacement;
    text << "\n  " << volumeText(result.hasVolume, result.volumeBefore, result.volumeAfter)
         << "\n  " << surfaceText(result) << "\n  work: " << result.rounds << " rounds";
    return text.str();
}

Warnings warningsOf(const DenoiseOptions& options, const std::string& summary,
                    const DenoiseResult& result) {
    Warnings warnings = surfaceWarnings(result);
    if (result.rounds > 0 && isAllFixed(result, result.V.rows()))
        warnings.push_back(allFixedWarning("move"));
    else if (options.strength > 0.0 && (result.maxDisplacement == 0.0 || result.isCrumpled))
        warnings.push_back({WarningCode::NothingRemoved, summary});
    constexpr double kHalf = 0.34;  // half a noiseless edge: noise lengthens edges
    if (result.diagnosis.noise.height > kHalf * result.diagnosis.noise.meanEdge)
        warnings.push_back(
            {WarningCode::HighNoise,
             "the noise is higher than half an edge: it hides details that cannot be recovered. "
             "Check the result, or remesh more coarsely first"});
    return warnings;
}

FilterOutput run(const FilterInput& input, const MeshLengths& mesh, const Values& given,
                 const Progress& progress) {
    DenoiseCall call = callOf(denoiseFields(), given, mesh);
    if (call.onlySelected) call.selected = input.selected;
    call.weight = weightOf(call.weightBy, input);
    if (input.whole) call.meanEdge = mesh.meanEdge;
    DenoiseResult result = denoise(input.V, input.F, call, progress);
    FilterOutput output;
    output.report = reportOf(denoiseEntries(), result);
    output.summary = summaryOf(call, result);
    const std::string note = call.strength == 0.0 ? "; strength 0: nothing changed" : "";
    output.text = reportText(output.summary + note, result, mesh.diagonal);
    output.warnings = warningsOf(call, output.summary, result);
    append(percentageWarnings(mesh), output.warnings);
    if (!input.whole) append(periodicWarnings(input.V, input.F, result.V), output.warnings);
    if (call.storeNoiseHeight) output.values = std::move(result.heights);
    output.V = std::move(result.V);
    return output;
}

}  // namespace

Filter denoiseContract() {
    return {"Spectral Denoise",
            "apply_coord_spectral_denoise",
            "Finds the noise of a mesh (scanner noise, spikes or voxel steps) and smooths it away, "
            "*without parameters*. Creases become sharp; a mesh without noise is left bit-for-bit "
            "unchanged. The log says what was found.",
            "",
            parametersOf(denoiseFields()),
            describedBy(denoiseEntries()),
            run};
}

}  // namespace spectral
