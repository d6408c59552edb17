#include <common/parameters/rich_parameters.h>

#include <cmath>
#include <iomanip>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "core/denoise/denoise.h"
#include "core/support/steady_progress.h"
#include "meshlab/filters/common_parameters.h"
#include "meshlab/filters/surface_report.h"
#include "meshlab/mesh_conversion.h"
#include "meshlab/mesh_filter.h"

namespace {

using spectral::DenoiseResult;
using spectral::NoiseKind;

const char* const kDenoiseHelp =
    "Detects which noise a mesh has (scanner noise, spikes or voxel steps) and removes it, with "
    "<b>nothing to choose</b>. Creases become sharp; a mesh without noise keeps every bit. The log "
    "says what was found.";

RichParameterList denoiseParameters(const MeshModel& mesh) {
    const spectral::DenoiseOptions defaults;
    const Scalarm diagonal = mesh.cm.bbox.Diag();
    const QString edge = meanEdgeText(meanEdge(mesh));
    RichParameterList list;
    list.addParam(RichFloat("strength", static_cast<Scalarm>(defaults.strength), "Strength",
                            "1 removes the noise as measured. More removes finer details, too; "
                            "less leaves some noise; 0 changes nothing."));
    list.addParam(RichPercentage(
        "noise_height", static_cast<Scalarm>(defaults.noiseHeight), 0, diagonal, "Noise height",
        "Standard deviation of the noise along the normals. 0: as measured; the log then says how "
        "high it is. Set it if details were mistaken for noise, or noise for details." +
            edge));
    list.addParam(RichPercentage(
        "noise_size", static_cast<Scalarm>(defaults.noiseSize), 0, diagonal, "Noise size",
        "Distance over which the noise is correlated: half the width of its bumps. Up to a mean "
        "edge, it is independent at each vertex. 0: as measured." +
            edge));
    list.addParam(selectedParameter(mesh, "four edges"));
    list.addParam(RichBool(
        "keep_creases", defaults.keepCreases, "Keep creases",
        "Do not smooth across creases. Off: creases are rounded; for shapes without any.", true));
    list.addParam(
        boundaryParameter("<b>free</b>: it moves along its normals, no further than the noise "
                          "explains. <b>fixed</b>: it stays exactly in place."));
    return list;
}

/// A length, in mean edges and in length units.
std::string lengthText(double length, double edge) {
    std::ostringstream text;
    text << std::setprecision(2) << length / edge << " edges" << std::setprecision(3) << " ("
         << length << ")";
    return text.str();
}

std::string voxelsText(const Eigen::RowVector3d& voxel) {
    std::ostringstream text;
    text << std::setprecision(3) << "voxel steps of " << voxel[0] << " x " << voxel[1] << " x "
         << voxel[2] << ": smoothed within half a voxel";
    return text.str();
}

std::string removedText(const spectral::DenoiseOptions& options, const DenoiseResult& result) {
    const double edge = result.diagnosis.noise.meanEdge;
    const bool isGiven = options.noiseHeight > 0.0;
    std::string text = isGiven                                          ? "noise"
                       : result.diagnosis.kind == NoiseKind::Correlated ? "scanner noise"
                       : result.diagnosis.kind == NoiseKind::Impulses   ? "impulse noise"
                                                                        : "white noise";
    text += ": height " +
            lengthText(isGiven ? options.noiseHeight : result.diagnosis.noise.height, edge);
    if (result.noiseSize > 0.0)
        text += ", size " +
                lengthText(isGiven ? result.noiseSize : result.diagnosis.noise.size * edge, edge);
    text += isGiven ? ", as given: removed" : ": removed";
    if (options.strength != 1.0) {
        std::ostringstream strength;
        strength << options.strength;
        text += ", times " + strength.str();
    }
    return text;
}

/// Why there is nothing to remove, and how to override that.
std::string nothingText(const DenoiseResult& result) {
    if (result.isCrumpled)
        return "the noise was not removed: that would have folded the surface over, which happens "
               "at needle triangles, e.g. of CAD models. Remesh first, or give a smaller noise "
               "height or size";
    switch (result.diagnosis.kind) {
        case NoiseKind::Tessellation:
            return "needle triangles as in a CAD model, not a scan: the mesh was not searched for "
                   "noise. If it has noise, give the noise height, or remesh first";
        case NoiseKind::TooFew:
            return "too few vertices to tell noise from shape. If the mesh has noise, give the "
                   "noise "
                   "height";
        default:
            return "no noise found that could not be part of the shape. For ripples several edges "
                   "wide, give noise height and noise size, e.g. a tenth of an edge and two edges, "
                   "or use Spectral Filter (Fractional)";
    }
}

/// What was found and done, in one line.
std::string summaryOf(const spectral::DenoiseOptions& options, const DenoiseResult& result) {
    if (options.strength == 0.0) return "strength 0; nothing changed";
    std::ostringstream text;
    if (const std::string note = selectionText(options.selected); !note.empty())
        text << note << "; ";
    if (result.diagnosis.spikes > 0)
        text << (result.diagnosis.spikes == 1 ? "a spike" : "spikes at ")
             << (result.diagnosis.spikes == 1 ? "" : std::to_string(result.diagnosis.spikes))
             << (result.diagnosis.spikes == 1 ? ": removed; " : " vertices: removed; ");
    if (result.rounds == 0) {
        text << nothingText(result);
        if (result.maxDisplacement == 0.0) text << "; nothing changed";
    } else if (result.noiseHeight == 0.0) {
        text << voxelsText(result.diagnosis.voxel);
    } else {
        text << removedText(options, result);
    }
    return text.str();
}

std::string reportText(const std::string& summary, const DenoiseResult& result) {
    std::ostringstream text;
    text << "Spectral Denoise: " << summary << std::setprecision(3) << "\n  the vertices moved by "
         << result.rmsDisplacement << " (root mean square), at most by " << result.maxDisplacement
         << "\n  " << volumeText(result.hasVolume, result.volumeBefore, result.volumeAfter)
         << "\n  " << surfaceText(result) << "\n  work: " << result.rounds << " rounds";
    return text.str();
}

std::vector<std::string> warningsOf(const spectral::DenoiseOptions& options,
                                    const std::string& summary, const DenoiseResult& result) {
    std::vector<std::string> warnings = surfaceWarnings(result);
    if (result.rounds > 0 && isAllFixed(result, result.V.rows()))
        warnings.push_back(allFixedWarning("move"));
    else if (options.strength > 0.0 && (result.maxDisplacement == 0.0 || result.isCrumpled))
        warnings.push_back(summary);
    constexpr double kHalf = 0.34;  // half a noiseless edge: noise lengthens edges
    if (result.diagnosis.noise.height > kHalf * result.diagnosis.noise.meanEdge)
        warnings.emplace_back(
            "the noise is higher than half an edge: it hides details that cannot be recovered. "
            "Check the result, or remesh more coarsely first");
    return warnings;
}

FilterOutcome applyDenoise(const RichParameterList& parameters, MeshModel& mesh,
                           const spectral::Progress& progress) {
    const MeshMatrices input = toMatrices(mesh.cm);
    spectral::DenoiseOptions options;
    options.strength = parameters.getFloat("strength");
    options.noiseHeight = parameters.getAbsPerc("noise_height");
    options.noiseSize = parameters.getAbsPerc("noise_size");
    options.selected = chosenVertices(parameters, mesh, input);
    options.keepCreases = parameters.getBool("keep_creases");
    options.boundary = boundaryCondition(parameters);
    const DenoiseResult result =
        spectral::withSteadyProgress(progress, spectral::denoise, input.V, input.F, options);
    reportWriting(input, mesh.cm, progress);
    setPositions(input, result.V, mesh);
    const std::string summary = summaryOf(options, result);
    const spectral::NoiseEstimate& noise = result.diagnosis.noise;
    std::map<std::string, QVariant> report{
        {"noise_height", result.noiseHeight},
        {"noise_size", result.noiseSize},
        {"estimated_noise_height", noise.height},
        {"estimated_noise_size", noise.size * noise.meanEdge},
        {"noise_correlation", noise.correlation},
        {"spikes", static_cast<int>(result.diagnosis.spikes)},
        {"voxel_size", QVariant::fromValue(Eigen::VectorXd(result.diagnosis.voxel))},
        {"mean_edge", noise.meanEdge},
        {"rounds", result.rounds}};
    addMovement(result, report);
    std::vector<std::string> warnings = warningsOf(options, summary, result);
    append(percentageWarnings(input), warnings);
    return {std::move(report), reportText(summary, result), std::move(warnings), summary};
}

}  // namespace

MeshFilter denoiseMeshFilter() {
    return {"Spectral Denoise", "apply_coord_spectral_denoise",
            kDenoiseHelp,       FilterPlugin::Smoothing,
            kMovesVertices,     denoiseParameters,
            applyDenoise};
}
