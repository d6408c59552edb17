#include "core/filter/fractional_filter.h"
#include "core/mesh/measures.h"
#include "core/support/steady_progress.h"
#include "meshlab/filters/fractional_help.h"
#include "meshlab/filters/fractional_parameters.h"
#include "meshlab/filters/fractional_report.h"
#include "meshlab/mesh_conversion.h"
#include "meshlab/mesh_filter.h"

namespace {

/// Name of the vertex attribute with the details.
const char* const kDetails = "spectral_details";

FilterOutcome applyFractional(const RichParameterList& parameters, MeshModel& mesh,
                              const spectral::Progress& progress) {
    const MeshMatrices input = toMatrices(mesh.cm);
    const spectral::FilterOptions options = fractionalFilterOptions(parameters, mesh, input);
    const bool detailsOnly = areDetailsWanted(parameters);
    const spectral::FilterResult result =
        spectral::withSteadyProgress(progress, [&](const spectral::Progress& steady) {
            return spectral::fractionalFilter(input.V, input.F, options, steady);
        });
    reportWriting(input, mesh.cm, progress);
    const double diagonal = spectral::boundingBoxDiagonal(input.V);
    std::string text = fractionalReportText(options, result, diagonal);
    if (detailsOnly) {
        setDetails(input.vertexIndex, kDetails, input.V - result.V, mesh);
        text += "\n  no vertex has moved: the details are the vertex quality, and the attribute ";
        text += kDetails;
    } else {
        setPositions(input.vertexIndex, result.V, mesh);
    }
    std::vector<std::string> warnings = fractionalWarnings(options, result, diagonal);
    for (std::string& unused : unusedParameters(parameters)) warnings.push_back(std::move(unused));
    return {reportDictionary(result), text, std::move(warnings)};
}

}  // namespace

MeshFilter fractionalMeshFilter() {
    MeshFilter filter;
    filter.name = "Spectral Filter (Fractional)";
    filter.pythonName = "apply_coord_spectral_filter_fractional";
    filter.help = fractionalFilterHelp();
    filter.category = FilterPlugin::Smoothing;
    filter.changes = MeshModel::MM_VERTCOORD | MeshModel::MM_VERTNORMAL | MeshModel::MM_FACENORMAL |
                     MeshModel::MM_VERTQUALITY;
    filter.parameters = fractionalFilterParameters;
    filter.apply = applyFractional;
    return filter;
}
