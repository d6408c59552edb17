#include "core/filter/fractional_filter.h"
#include "core/mesh/measures.h"
#include "core/support/steady_progress.h"
#include "meshlab/filters/common_parameters.h"
#include "meshlab/filters/fractional_parameters.h"
#include "meshlab/filters/fractional_report.h"
#include "meshlab/filters/surface_report.h"
#include "meshlab/mesh_conversion.h"
#include "meshlab/mesh_filter.h"

namespace {

// Three lines: MeshLab shows all of it above the parameters.
const char* const kFractionalHelp =
    "Smooths, sharpens or enhances details <b>by their size</b>, as an equalizer filters sound. "
    "Low-pass: details larger than the feature size stay, smaller ones go. <small>Kovnatsky, "
    "Bronstein, Bronstein: <i>Stable Spectral Mesh Filtering</i>, 2012</small>";

/// Vertex attribute that holds the details.
const char* const kDetails = "spectral_details";

FilterOutcome applyFractional(const RichParameterList& parameters, MeshModel& mesh,
                              const spectral::Progress& progress) {
    const MeshMatrices input = toMatrices(mesh.cm);
    const spectral::FilterOptions options = fractionalFilterOptions(parameters, mesh, input);
    const bool detailsOnly = areDetailsWanted(parameters);
    const spectral::FilterResult result = spectral::withSteadyProgress(
        progress, spectral::fractionalFilter, input.V, input.F, options);
    reportWriting(input, mesh.cm, progress);
    const double diagonal = spectral::boundingBoxDiagonal(input.V);
    std::string text = fractionalReportText(options, result, diagonal);
    if (detailsOnly) {
        setDetails(input.vertexIndex, kDetails, input.V - result.V, mesh);
        text +=
            "\n  no vertex has moved: the details are stored as the vertex quality and the "
            "attribute ";
        text += kDetails;
    } else {
        setPositions(input, result.V, mesh);
    }
    std::vector<std::string> warnings = fractionalWarnings(options, result, diagonal);
    append(percentageWarnings(input), warnings);
    append(unusedParameters(parameters), warnings);
    return {reportDictionary(result), text, std::move(warnings)};
}

}  // namespace

MeshFilter fractionalMeshFilter() {
    return {"Spectral Filter (Fractional)",
            "apply_coord_spectral_filter_fractional",
            kFractionalHelp,
            FilterPlugin::Smoothing,
            kMovesVertices | MeshModel::MM_VERTQUALITY,
            fractionalFilterParameters,
            applyFractional};
}
